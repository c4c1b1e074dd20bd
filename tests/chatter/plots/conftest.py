"""Pictures are looked at here: room is made for their labels."""

import pytest


@pytest.fixture(autouse=True)
def layout_of_pictures():
    """Leave the layout as it is; see the fixture of this name in tests/conftest.py."""
