"""Titles are what people write: in any alphabet, and with characters that no font has."""

import warnings

import pytest

from chatter.plots.style import new_figure, png_of


@pytest.mark.parametrize("title", ["Planfräsen 立铣", "a\tb", "фреза \u202e\u0007"])
def test_a_title_in_any_letters_is_drawn_without_a_warning(title):
    figure = new_figure(3.0, 2.0)
    figure.add_subplot().set_title(title)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert png_of(figure).startswith(b"\x89PNG")
