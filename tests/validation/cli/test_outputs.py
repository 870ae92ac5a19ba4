"""Where results go: links, pipes, modes of files, standard output, and names in any case."""

import io
import os
import stat
import subprocess
import sys
import threading
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from analysis import load_run
from analysis.data.files import whole_file
from tests.calls import printed, refusal, run
from tests.helpers import random_trajectory

posix = pytest.mark.skipif(os.name != "posix", reason="links, pipes and modes of POSIX")

SPINS = "eigenvalues --system reduced --spin 30 40"


def save_page(path: Path) -> None:
    random_trajectory().save(path.with_name("motion.npz"))
    assert run("animate", str(path.with_name("motion.npz")), "--out", str(path)) == 0


def save_table(path: Path) -> None:
    assert run(SPINS, "--csv", str(path)) == 0


def save_picture(path: Path) -> None:
    assert run(SPINS, "--plot", str(path)) == 0


WAYS: list[tuple[str, Callable[[Path], None]]] = [
    ("run.csv", lambda path: random_trajectory().to_csv(path)),
    ("run.npz", lambda path: random_trajectory().save(path)),
    ("table.csv", save_table),
    ("picture.png", save_picture),
    ("page.html", save_page),
]


@posix
@pytest.mark.parametrize(("name", "save"), WAYS)
def test_link_stays_and_what_it_leads_to_is_replaced(
    name: str, save: Callable[[Path], None], tmp_path: Path
) -> None:
    (tmp_path / "elsewhere").mkdir()
    target, link = tmp_path / "elsewhere" / name, tmp_path / name
    link.symlink_to(target)
    for before in (None, b"an older result"):
        if before is not None:
            target.write_bytes(before)
        save(link)
        assert link.is_symlink()
        assert target.stat().st_size > 100
        assert [each.name for each in target.parent.iterdir()] == [name]


@posix
@pytest.mark.parametrize(("name", "save"), WAYS)
@pytest.mark.parametrize("mode", [0o600, 0o640])
def test_file_keeps_its_mode(
    name: str, save: Callable[[Path], None], mode: int, tmp_path: Path
) -> None:
    path = tmp_path / name
    path.touch()
    path.chmod(mode)
    save(path)
    assert stat.S_IMODE(path.stat().st_mode) == mode
    assert path.stat().st_size > 100


@posix
@pytest.mark.parametrize(("name", "save"), WAYS)
def test_pipe_is_written_to_and_stays_one(
    name: str, save: Callable[[Path], None], tmp_path: Path
) -> None:
    pipe, plain = tmp_path / name, tmp_path / f"plain-{name}"
    os.mkfifo(pipe)
    read: list[bytes] = []
    reader = threading.Thread(target=lambda: read.append(pipe.read_bytes()), daemon=True)
    reader.start()
    save(pipe)
    reader.join(timeout=20.0)
    assert stat.S_ISFIFO(pipe.stat().st_mode)
    save(plain)
    if name.endswith(".npz"):
        # An archive that cannot be gone back in says how long its members are behind them.
        pipe.unlink()
        pipe.write_bytes(read[0])
        np.testing.assert_array_equal(load_run(pipe).times, load_run(plain).times)
    else:
        assert read == [plain.read_bytes()]


@posix
def test_failed_run_writes_nothing_into_a_pipe(tmp_path: Path) -> None:
    pipe = tmp_path / "pipe"
    os.mkfifo(pipe)

    def fail_half_way() -> None:
        with whole_file(pipe) as stream:
            stream.write(b"half of it")
            raise ArithmeticError

    # Opening a pipe that nobody reads would wait for ever.
    with pytest.raises(ArithmeticError):
        fail_half_way()


@posix
def test_dash_is_standard_output(capfd: pytest.CaptureFixture[str]) -> None:
    assert run(SPINS, "--csv -") == 0
    shown = capfd.readouterr()
    assert [line.partition(",")[0] for line in shown.out.splitlines()] == [
        "spin in rad/s", "30.0", "40.0",
    ]  # fmt: skip
    assert shown.err == ""


@posix
def test_what_else_is_printed_goes_beside_a_file_on_standard_output(
    tmp_path: Path, capfdbinary: pytest.CaptureFixture[bytes]
) -> None:
    call = "simulate --source in-house --end 0.01 --samples 3 --out /dev/stdout"
    assert run(call) == 0
    shown = capfdbinary.readouterr()
    assert b"/dev/stdout: 3 samples" in shown.err
    (tmp_path / "run.npz").write_bytes(shown.out)
    assert load_run(tmp_path / "run.npz").times.size == 3


@posix
def test_store_is_no_pipe(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    os.mkfifo(tmp_path / "sweep.db")
    said = refusal(capsys, "sweep spin=30,40 --out", str(tmp_path / "sweep.db"))
    assert "--out: must be a regular file" in said


def test_suffixes_are_known_in_any_case(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    file = str(tmp_path / "RUN.NPZ")
    assert run("simulate --source in-house --end 0.01 --samples 3 --out", file) == 0
    assert "RUN: Trajectory(" in printed(capsys, "show", file, "--plot", str(tmp_path / "RUN.PNG"))
    assert "[friction]" in printed(capsys, "scenario", file)
    assert run("animate", file, "--fps 10 --width 100 --out", str(tmp_path / "RUN.GIF")) == 0
    assert (tmp_path / "RUN.GIF").stat().st_size > 100


@pytest.mark.parametrize("encoding", ["ascii", "cp1252"])
def test_output_without_greek_letters_gets_the_table_with_replacements(
    encoding: str, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    whole = printed(capsys, SPINS)
    assert "λ" in whole
    narrow = io.BytesIO()
    monkeypatch.setattr(sys, "stdout", io.TextIOWrapper(narrow, encoding=encoding))
    assert run(SPINS) == 0
    assert narrow.getvalue().decode(encoding) == whole.replace("λ", "?")
    assert capsys.readouterr().err == ""


@pytest.mark.slow
def test_home_that_cannot_be_written_to_is_not_spoken_of(tmp_path: Path) -> None:
    (tmp_path / "home").touch()
    done = subprocess.run(
        [sys.executable, "-m", "validation", *SPINS.split(), "--plot", str(tmp_path / "p.png")],
        capture_output=True,
        text=True,
        check=False,
        cwd=Path(__file__).parents[3],
        env={
            name: value
            for name, value in os.environ.items()
            if name not in ("MPLCONFIGDIR", "XDG_CACHE_HOME", "XDG_CONFIG_HOME")
        }
        | {"HOME": str(tmp_path / "home")},
    )
    assert (done.returncode, done.stderr) == (0, "")
    assert (tmp_path / "p.png").stat().st_size > 100


def test_spins_are_taken_in_any_order(capsys: pytest.CaptureFixture[str]) -> None:
    rising = printed(capsys, "eigenvalues --system reduced --json --spin 30.2 30.5 30.8")
    for spins in ("30.8,30.2 30.5", "30.5 30.8:30.2", "30.8:30.2:3", "30.5,30.2,30.8,30.5"):
        assert printed(capsys, "eigenvalues --system reduced --json --spin", spins) == rising
    rising = printed(capsys, "critical --system reduced --json --spin 20:40")
    for spins in ("40:20", "20 40", "40,30,20", "20:40:5"):
        assert printed(capsys, "critical --system reduced --json --spin", spins) == rising
