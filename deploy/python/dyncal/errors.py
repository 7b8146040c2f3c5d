"""The one exception of dyncal: a code for programs, a sentence for people."""

from __future__ import annotations

from typing import Literal

Code = Literal[
    "too_few_samples",
    "not_finite",
    "stamps_not_increasing",
    "no_excitation",
    "frequency_out_of_range",
    "ill_conditioned",
    "not_converged",
    "out_of_calibration",
    "invalid_argument",
    "bad_file",
]


class Error(ValueError):
    """Why there is no number to give.

    code: of a closed set (analysis/base/error.hpp; "bad_file" of files), for programs.
    str(error): what, where and what to do about it, in one sentence.
    """

    def __init__(self, code: Code, message: str) -> None:
        super().__init__(message)
        self.code: Code = code

    def __reduce__(self) -> tuple[type[Error], tuple[Code, str]]:
        return type(self), (self.code, str(self))
