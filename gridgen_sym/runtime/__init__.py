"""Generated kernels, compiled or in NumPy, as one object that solvers hold."""

from ..cache import cache_folder as cache_folder
from .backend import choose_backend as choose_backend
from .block_kernels import BlockKernels as BlockKernels
from .compiler import compile_library as compile_library
from .compiler import find_compiler as find_compiler
from .compiler import open_library as open_library
from .kernel_set import HESSIAN_PLANES as HESSIAN_PLANES
from .kernel_set import JACOBIAN_PLANES as JACOBIAN_PLANES
from .kernel_set import KernelSet as KernelSet
from .kernels import kernels as kernels
from .threads import thread_count as thread_count
from .threads import threads_for as threads_for
from .values import Values as Values
