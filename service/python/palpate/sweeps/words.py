# mypy: ignore-errors
"""How a sweep says no."""


BAD_VALUE = 3  # palpate.h


def refuse(sentence):
    """Raises PalpateError with this sentence."""
    from palpate import PalpateError  # late: palpate itself imports this package

    raise PalpateError(BAD_VALUE, sentence) from None
