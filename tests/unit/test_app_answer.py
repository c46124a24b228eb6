"""Tables of an answer that the page opens."""

import pytest

from asperity.app.answer_job import rows_in


def test_rows_of_other_versions(tmp_path):
    (tmp_path / "answer.csv").write_text("group,name,value,unit,later\ncontact,real contact,0.1,1,x\n")
    assert rows_in(tmp_path) == [{"group": "contact", "name": "real contact", "value": 0.1, "unit": "1"}]
    (tmp_path / "answer.csv").write_text("group,name,value\ncontact,real contact,0.1\n")
    with pytest.raises(KeyError, match="unit"):
        rows_in(tmp_path)
