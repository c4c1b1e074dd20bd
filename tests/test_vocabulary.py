"""Names, keys, messages and docs use the field's terms; `tests/vocabulary.py` has the table."""

from tests.vocabulary import all_hits, in_names, in_text


def test_no_word_that_has_a_term_of_the_field():
    assert [str(hit) for hit in all_hits()] == []


def test_the_walk_finds_wordsin_names_and_texts():
    assert [hit.term for hit in in_names("chatter/x.py", 1, "limitDepth_of")] == ["critical depth"]
    assert not list(in_names("chatter/x.py", 1, "growth_rate"))
    assert not list(in_names("dynamics/drive/x.py", 1, "screw_lead"))
    assert [hit.term for hit in in_text("docs/x.md", 1, "once per turn")] == ["revolution"]
    assert not list(in_text("docs/x.md", 1, "in turn"))
