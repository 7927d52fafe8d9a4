"""Generated kernels, compiled or in NumPy, as one object that solvers hold."""

from .cache import cache_folder as cache_folder
from .compiler import compile_library as compile_library
from .compiler import find_compiler as find_compiler
from .compiler import open_library as open_library
from .kernels import HESSIAN_PLANES as HESSIAN_PLANES
from .kernels import Array as Array
from .kernels import KernelSet as KernelSet
from .kernels import Mask as Mask
from .kernels import choose_backend as choose_backend
from .kernels import kernels as kernels
from .kernels import thread_count as thread_count
