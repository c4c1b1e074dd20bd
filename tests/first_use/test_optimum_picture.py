"""The picture of an optimum says what its darker fill keeps."""

from types import SimpleNamespace

from chatter.plots.optimum import _kept


def test_what_is_kept_with_a_confidence_is_not_called_a_margin():
    """The words "with margins" stood for a fill up to the limit itself, with a confidence."""
    usual = SimpleNamespace(depth_margin=0.15, speed_margin=0.015, confidence=0.95)
    sure = SimpleNamespace(depth_margin=0.0, speed_margin=0.0, confidence=0.9)
    assert "with margins" in _kept(usual)
    assert "margin" not in _kept(sure)
    assert "0.9" in _kept(sure)
