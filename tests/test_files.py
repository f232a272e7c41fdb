"""Files are replaced as a whole or not at all."""

import pytest

from jaxsusp._files import atomic_path, write_text


@pytest.mark.fast
def test_new_content_replaces_the_old(tmp_path):
    target = tmp_path / "table.csv"
    target.write_text("old")
    write_text(target, "new – with a dash")
    assert target.read_text(encoding="utf-8") == "new – with a dash"
    assert list(tmp_path.iterdir()) == [target]


@pytest.mark.fast
@pytest.mark.parametrize("error", [RuntimeError, KeyboardInterrupt])
def test_a_failure_leaves_the_old_file_and_no_debris(tmp_path, error):
    target = tmp_path / "table.csv"
    target.write_text("old")

    def fail_half_way():
        with atomic_path(target) as scratch:
            scratch.write_text("half of the n")
            raise error

    with pytest.raises(error):
        fail_half_way()
    assert target.read_text() == "old"
    assert list(tmp_path.iterdir()) == [target]


@pytest.mark.fast
def test_the_target_keeps_its_old_content_while_the_new_is_written(tmp_path):
    target = tmp_path / "table.csv"
    target.write_text("old")
    with atomic_path(target) as scratch:
        scratch.write_text("new")
        assert target.read_text() == "old"
        assert scratch.parent == tmp_path
        assert scratch.suffix == ".csv"
    assert target.read_text() == "new"


@pytest.mark.fast
def test_a_link_stays_a_link(tmp_path):
    real, link = tmp_path / "real.txt", tmp_path / "link.txt"
    real.write_text("old")
    link.symlink_to(real)
    write_text(link, "new")
    assert link.is_symlink()
    assert real.read_text() == "new"


@pytest.mark.fast
def test_a_missing_folder_is_named(tmp_path):
    with pytest.raises(FileNotFoundError, match="there is no folder"):
        write_text(tmp_path / "absent" / "table.csv", "text")


@pytest.mark.fast
def test_a_block_that_writes_nothing_changes_nothing(tmp_path):
    target = tmp_path / "table.csv"
    target.write_text("old")
    with pytest.raises(FileNotFoundError), atomic_path(target):
        pass
    assert target.read_text() == "old"
