"""Results in a notebook: sentences escaped, picture inlined."""

import base64
import re

import pytest

import chatter
from chatter.description.case import loads
from tests.cases import TOOL_OF_922_HERTZ


@pytest.mark.parametrize("call", [chatter.check, chatter.simulate])
def test_a_result_shows_itself(call):
    case = loads(TOOL_OF_922_HERTZ).patch({"title": "<script>x</script>"})
    html = call(case)._repr_html_()
    assert "<script>" not in html
    (source,) = re.findall(r'src="data:image/png;base64,([^"]+)"', html)
    assert base64.b64decode(source).startswith(b"\x89PNG")


def test_a_check_shows_its_verdict_and_its_table():
    result = chatter.check(loads(TOOL_OF_922_HERTZ))
    html = result._repr_html_()
    assert result.sentences()[0] in html
    assert html.count("<tr>") == len(result.rows())
