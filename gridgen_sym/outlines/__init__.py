"""Outline files: one module for each format, and what finds the format of a file."""

from .content import OutlineContent as OutlineContent
from .format import OutlineFormat as OutlineFormat
from .registry import is_outline as is_outline
from .registry import outline_formats as outline_formats
from .registry import outline_suffixes as outline_suffixes
from .registry import read_content as read_content
