"""The launcher, without building a root: made-up environments and builders take the place of the slow ones."""

import contextlib
import importlib.util
import os
import resource
import signal
import subprocess
import sys
import threading
import time
from importlib.machinery import SourceFileLoader
from pathlib import Path
from types import ModuleType, SimpleNamespace

import pytest

PROJECT = Path(__file__).resolve().parent.parent
LAUNCHER = PROJECT / "launcher"
sys.path.insert(0, str(LAUNCHER))

import bubblewrap  # noqa: E402
import building  # noqa: E402
import debian_root  # noqa: E402
import fill_venv  # noqa: E402
import places  # noqa: E402

OWN = tuple("DEBOND_ OMP_ OPENBLAS_ MKL_ OMPI_ PRTE_ PYTHONPATH PYTHONPYCACHEPREFIX PYTHONDONTWRITEBYTECODE".split())


@pytest.fixture(autouse=True)
def outside(monkeypatch):
    """The tests themselves run in an environment of the launcher; its variables would shadow what is tested."""
    for name in list(os.environ):
        if name.startswith(OWN):
            monkeypatch.delenv(name)


@pytest.fixture
def cache(tmp_path, monkeypatch):
    """A cache folder with a finished environment without DOLFINx: this very Python."""
    folder = tmp_path / "cache"
    venv = places.plain_venv(folder, sys.executable)
    (venv / "bin").mkdir(parents=True)
    (venv / "bin" / "python").symlink_to(sys.executable)
    (venv / "whole").touch()
    monkeypatch.setenv("DEBOND_CACHE", str(folder))
    monkeypatch.setenv("DEBOND_NO_DOLFINX", "1")
    return folder


def start(*arguments: str, cwd: Path = PROJECT) -> subprocess.CompletedProcess:
    """Run the launcher to its end."""
    command = [sys.executable, str(PROJECT / "debond"), *arguments]
    return subprocess.run(command, cwd=cwd, capture_output=True, text=True, timeout=60)


def variable(name: str) -> str:
    """What a program in the environment sees as ``name``."""
    return start("exec", sys.executable, "-c", f"import os; print(os.environ.get({name!r}, ''))").stdout.strip()


@pytest.mark.usefixtures("cache")
def test_exit_code_passes_through():
    assert start("exec", "sh", "-c", "exit 7").returncode == 7


@pytest.mark.usefixtures("cache")
def test_arguments_pass_unchanged(tmp_path):
    words = ["two words", "--slow", "", "*", "load.opening=[1.0, 0.2]"]
    done = start("exec", sys.executable, "-c", "import os, sys; print(os.getcwd(), sys.argv[1:])", *words, cwd=tmp_path)
    assert done.stdout.strip() == f"{tmp_path.resolve()} {words}"


@pytest.mark.usefixtures("cache")
def test_unknown_program_is_named():
    done = start("exec", "no-such-program")
    assert done.returncode == 127
    assert "no-such-program" in done.stderr and "Traceback" not in done.stderr


@pytest.mark.usefixtures("cache")
def test_project_is_importable_from_anywhere(tmp_path):
    (tmp_path / "verify").mkdir()
    done = start("exec", "python", "-P", "-c", "import iga, verify.result; print(verify.result.__file__)", cwd=tmp_path)
    assert done.stdout.strip() == str(PROJECT / "verify" / "result.py")


def test_environment_of_a_program(cache, monkeypatch):
    assert variable("OMP_NUM_THREADS") == variable("OPENBLAS_NUM_THREADS") == variable("MKL_NUM_THREADS") == "1"
    assert variable("OMPI_ALLOW_RUN_AS_ROOT") == variable("OMPI_ALLOW_RUN_AS_ROOT_CONFIRM") == "1"
    assert variable("OMPI_MCA_btl") == "^tcp,ofi", "libfabric looks for networks for a second"
    assert variable("PATH").startswith(str(places.plain_venv(cache, sys.executable) / "bin"))
    assert Path(variable("XDG_CACHE_HOME")).is_relative_to(cache)
    monkeypatch.setenv("OMP_NUM_THREADS", "2")
    assert variable("OMP_NUM_THREADS") == variable("OPENBLAS_NUM_THREADS") == "2"


def test_compiled_files_have_a_place_where_the_sources_take_none(cache, monkeypatch):
    assert variable("PYTHONPYCACHEPREFIX") == ""
    monkeypatch.setenv("PYTHONDONTWRITEBYTECODE", "1")
    assert variable("PYTHONDONTWRITEBYTECODE") == ""
    assert Path(variable("PYTHONPYCACHEPREFIX")).is_relative_to(cache)


def test_a_launcher_inside_sets_nothing_up(tmp_path, monkeypatch):
    monkeypatch.setenv("DEBOND_INSIDE", sys.prefix)
    monkeypatch.setenv("DEBOND_CACHE", str(tmp_path / "cache"))
    assert start("exec", "true").returncode == 0
    assert not (tmp_path / "cache").exists()


@pytest.mark.usefixtures("cache")
def test_second_start_is_fast():
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    assert start("exec", "true").returncode == 0
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    assert after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime < 0.5  # whatever else the machine does


def the_launcher() -> ModuleType:
    loader = SourceFileLoader("debond_launcher", str(PROJECT / "debond"))
    launcher = importlib.util.module_from_spec(importlib.util.spec_from_loader("debond_launcher", loader))
    loader.exec_module(launcher)
    return launcher


def test_test_verb():
    launcher = the_launcher()
    pytest_command = ["python", "-P", "-m", "pytest", "-p", "debond.pytest_plugin"]
    assert launcher.command(["test", "-k", "x"], "python") == [*pytest_command, "-k", "x"]
    assert launcher.command(["test", "--slow", "-q"], "python") == [*pytest_command, "-m", "", "-q"]
    whole = ["-n", "auto", "--dist", "worksteal"]
    assert launcher.command(["test"], "python") == [*pytest_command, *whole]
    assert launcher.command(["test", "--slow"], "python") == [*pytest_command, "-m", "", *whole]
    assert launcher.command(["solve", "--slow"], "python") == ["python", "-P", "-m", "verify", "solve", "--slow"]
    assert launcher.command(["exec", "pytest", "x.py"], "python") == ["pytest", "-p", "debond.pytest_plugin", "x.py"]


@pytest.mark.parametrize("root", [None, Path("/root-of-debian")])
def test_tests_alone_ask_for_what_they_need_and_know_where_they_are(root, tmp_path, monkeypatch):
    launcher, asked, seen = the_launcher(), [], []
    monkeypatch.setattr(places, "inside", lambda: None)
    monkeypatch.setattr(places, "find", lambda tests: asked.append(tests) or places.Place(tmp_path, tmp_path, root))
    monkeypatch.setattr(launcher, "run_in_root", lambda root, words, environment, *_: seen.append(environment) or 0)
    monkeypatch.setattr(launcher.os, "execvpe", lambda name, words, environment: seen.append(environment))
    monkeypatch.setattr(launcher.os, "chdir", lambda folder: None)
    for words in (["exec", "true"], ["test"]):
        launcher.main(words)
    assert asked == [False, True]
    assert [one.get("DEBOND_TESTS_IN") for one in seen] == [None, "root" if root else "venv"]
    monkeypatch.setattr(places, "inside", lambda: places.Place(tmp_path, tmp_path, root))
    launcher.main(["test"])
    assert len(asked) == 2 and "DEBOND_TESTS_IN" not in seen[-1], "nothing is set up from within"


def test_cache_that_cannot_be_written_is_a_sentence(tmp_path, monkeypatch):
    (tmp_path / "file").touch()
    monkeypatch.setenv("DEBOND_CACHE", str(tmp_path / "file" / "cache"))
    monkeypatch.setenv("DEBOND_NO_DOLFINX", "1")
    done = start("exec", "true")
    assert done.returncode == 3
    assert "cannot be written" in done.stderr and "set DEBOND_CACHE" in done.stderr
    assert "Traceback" not in done.stderr


def started_by(version: tuple[int, ...], tmp_path: Path) -> subprocess.CompletedProcess:
    """The launcher by a Python that takes itself for another, which finds no newer one."""
    script = (
        f"import runpy, sys; sys.version_info = {version}; sys.version = '{'.'.join(map(str, version))} (made up)'\n"
        f"sys.argv = ['debond', 'exec', 'true']; runpy.run_path({str(PROJECT / 'debond')!r}, run_name='__main__')"
    )
    own = {"DEBOND_CACHE": str(tmp_path / "cache"), "DEBOND_NO_DOLFINX": "1", "PATH": str(tmp_path)}
    return subprocess.run([sys.executable, "-c", script], env=own, capture_output=True, text=True, timeout=60)


def test_a_python_that_is_too_old_is_a_sentence(tmp_path):
    done = started_by((3, 8, 18), tmp_path)
    assert done.returncode == 3
    assert done.stderr == "debond: must be started by Python 3.9 or newer, got 3.8.18; install one\n"
    done = started_by((3, 10, 2), tmp_path)
    assert done.returncode == 3
    assert done.stderr == "debond: Python 3.11 or newer is needed and this is 3.10.2; install a newer one\n"


def test_the_first_start_without_network_is_a_sentence(tmp_path, monkeypatch):
    """The real pip against a server that nobody is: nothing that is half built is taken for whole afterwards."""
    monkeypatch.setenv("DEBOND_CACHE", str(tmp_path / "cache"))
    monkeypatch.setenv("DEBOND_NO_DOLFINX", "1")
    monkeypatch.setenv("PIP_INDEX_URL", "http://127.0.0.1:9/simple")
    monkeypatch.setenv("PIP_RETRIES", "1")
    monkeypatch.setenv("PIP_CONFIG_FILE", os.devnull)
    for name in ("PIP_EXTRA_INDEX_URL", "PIP_FIND_LINKS"):
        monkeypatch.delenv(name, raising=False)
    done = start("exec", "true")
    assert done.returncode == 3 and "Traceback" not in done.stderr
    assert "the package server cannot be reached; check the network" in done.stderr.splitlines()[-1]
    assert not list((tmp_path / "cache").glob("venv-*/whole"))


@pytest.fixture
def builds(monkeypatch):
    """The roots that a made-up builder has built."""
    made = []

    def build(command: list[str], log: Path, what: str, env: object = None) -> None:
        part = next(Path(word) for word in command if word.endswith(".part"))
        assert not part.exists()
        time.sleep(0.2)
        part.mkdir()
        (part / "etc").mkdir()
        made.append(part)

    monkeypatch.setattr(debian_root, "run_logged", build)
    monkeypatch.setattr(debian_root, "get_tools", lambda: None)
    monkeypatch.setattr(debian_root, "can_enter", lambda: None)
    monkeypatch.setattr(debian_root.os, "geteuid", lambda: 0)
    monkeypatch.setattr(debian_root.shutil, "which", lambda name: name)
    return made


def test_half_built_root_is_never_used(tmp_path, builds):
    root = debian_root.root_folder(tmp_path)
    part = root.with_name(root.name + ".part")
    (part / "usr").mkdir(parents=True)
    assert debian_root.provide(tmp_path) == root
    assert builds == [part] and not part.exists()
    assert [path.name for path in root.iterdir()] == ["etc"]


def test_two_starts_build_once(tmp_path, builds):
    starts = [threading.Thread(target=debian_root.provide, args=(tmp_path,)) for _ in range(3)]
    for thread in starts:
        thread.start()
    for thread in starts:
        thread.join()
    assert len(builds) == 1


def test_failed_build_is_remembered(tmp_path, builds, monkeypatch):
    def fail(*_: object) -> None:
        raise building.Trouble("building failed: the disk is full")

    with monkeypatch.context() as patch:
        patch.setattr(debian_root, "run_logged", fail)
        with pytest.raises(building.Trouble, match="the disk is full"):
            debian_root.provide(tmp_path)
    with pytest.raises(building.Trouble, match="to try again now: rm"):
        debian_root.provide(tmp_path)
    assert builds == []
    next(tmp_path.glob("*.failed")).unlink()
    assert debian_root.provide(tmp_path).is_dir()


def test_suites_have_roots_of_their_own(tmp_path, monkeypatch):
    stable = debian_root.root_folder(tmp_path)
    assert not any("Check-Valid-Until" in word for word in debian_root.recipe(tmp_path / "stable"))
    monkeypatch.setenv("DEBOND_SUITE", "sid")
    assert debian_root.root_folder(tmp_path) != stable
    assert any("Check-Valid-Until" in word for word in debian_root.recipe(tmp_path / "sid"))


def test_a_root_for_tests_is_another_one_and_serves_all_else(tmp_path, builds):
    plain = debian_root.provide(tmp_path)
    whole = debian_root.provide(tmp_path, tests=True)
    assert plain != whole and debian_root.provide(tmp_path) == whole == debian_root.provide(tmp_path, tests=True)
    assert [part.name for part in builds] == [f"{plain.name}.part", f"{whole.name}.part"]
    words = [next(word for word in debian_root.recipe(plain, tests) if "include" in word) for tests in (False, True)]
    assert ["chromium" in word for word in words] == [False, True] and all("python3-dolfinx" in word for word in words)


def test_packages_of_tests_are_added_to_what_is_there(tmp_path, monkeypatch):
    venv, ran = places.plain_venv(tmp_path, sys.executable), []

    def run(words: list[str], *_: object) -> None:
        ran.append([Path(word).name for word in words[1:3]] + words[3:4])
        (venv / "bin").mkdir(parents=True, exist_ok=True)

    monkeypatch.setattr(places, "run_logged", run)
    for tests in (False, True, False, True):
        assert places.plain(tmp_path, tests).venv == venv
    assert ran == [["-m", "venv", str(venv)], ["fill_venv.py"], ["fill_venv.py", "tests"]]


def test_what_tests_need_is_declared():
    wishes = {word.split(">")[0].split("[")[0] for word in fill_venv.requirements(tests=True)}
    assert {"numpy", "pytest", "matplotlib", "meshio", "h5py", "pyvista", "distributed", "zensical", "mypy"} <= wishes
    assert not {"h5py", "pyvista", "distributed", "zensical"} & {
        word.split(">")[0] for word in fill_venv.requirements(tests=False)
    }
    pinned = {line.split("==")[0].lower().replace("_", "-") for line in fill_venv.constraints()}
    assert wishes - {"numpy", "scipy"} <= pinned


def test_half_built_venv_is_built_anew(tmp_path, monkeypatch):
    venv = places.plain_venv(tmp_path, sys.executable)
    (venv / "bin").mkdir(parents=True)
    (venv / "bin" / "leftover").touch()
    monkeypatch.setattr(places, "run_logged", lambda *_: (venv / "bin").mkdir(parents=True, exist_ok=True))
    assert places.plain(tmp_path).venv == venv
    assert places.is_whole(venv) and not (venv / "bin" / "leftover").exists()
    assert os.access(venv / "bin" / "debond", os.X_OK)


def test_without_tools_it_goes_on_without_dolfinx(cache, monkeypatch, capsys):
    monkeypatch.delenv("DEBOND_NO_DOLFINX")
    monkeypatch.setattr(places, "python_with_dolfinx", lambda: None)
    monkeypatch.setattr(debian_root.shutil, "which", lambda name: None if name in debian_root.TOOLS else name)
    monkeypatch.setattr(debian_root.os, "geteuid", lambda: 1000)
    assert places.find().root is None
    said = capsys.readouterr().err
    assert "as root: apt-get install mmdebstrap bubblewrap" in said
    assert "without DOLFINx" in said


@pytest.mark.parametrize(
    ("line", "word"),
    [
        ("Temporary failure resolving 'mirror.example'", "network"),
        ("E: Could not connect to mirror.example:80, connection timed out", "network"),
        ("NewConnectionError('Failed to establish a new connection')", "network"),
        ("dpkg: error: failed to write: No space left on device", "disk is full"),
        ("W: GPG error: NO_PUBKEY 6ED0E7B82643E131", "debian-archive-keyring"),
        ("The virtual environment was not created because ensurepip is not available", "python3-venv"),
        ("OSError: [Errno 30] Read-only file system", "DEBOND_CACHE"),
    ],
)
def test_cause_of_a_failure(tmp_path, line, word):
    builder = [sys.executable, "-c", f"print({line!r}); raise SystemExit(1)"]
    with pytest.raises(building.Trouble, match=word):
        building.run_logged(builder, tmp_path / "log", "building")
    assert line in (tmp_path / "log").read_text()


def test_full_disk_is_a_sentence(tmp_path, monkeypatch):
    monkeypatch.setattr(building.shutil, "disk_usage", lambda _: SimpleNamespace(free=1.5e9))
    with pytest.raises(building.Trouble, match=r"has 1\.5 GB free and 3 GB are needed"):
        building.need_space(tmp_path, 3.0)


def test_host_folders_are_seen_and_system_folders_are_not(tmp_path):
    words = bubblewrap.mounts(tmp_path, PROJECT, (PROJECT,))
    bound = {words[i + 1] for i, word in enumerate(words) if word in ("--bind", "--ro-bind")}
    own = {f"/{name}" for name in os.listdir("/") if Path("/", name).is_dir() and not Path("/", name).is_symlink()}
    assert {path for path in own if path[1:] not in bubblewrap.SYSTEM and not path.startswith("/.")} <= bound
    assert bound.isdisjoint({"/usr", "/etc", "/var", "/bin"})
    assert all((tmp_path / path[1:]).exists() for path in bound if path in own and path != "/sys")


FAKE_BWRAP = """#!{python}
import os, subprocess, sys
words = sys.argv[1:]
chdir = words.index("--chdir")
child = subprocess.Popen(words[chdir + 2 :], cwd=words[chdir + 1])
info = int(words[words.index("--info-fd") + 1])
os.write(info, b'{{"child-pid": %d}}' % child.pid)
os.close(info)
code = child.wait()
sys.exit(code if code >= 0 else 128 - code)
"""


@pytest.fixture
def root(tmp_path, monkeypatch):
    """A root that a made-up bubblewrap enters by doing nothing."""
    program = tmp_path / "programs" / "bwrap"
    program.parent.mkdir()
    program.write_text(FAKE_BWRAP.format(python=sys.executable))
    program.chmod(0o755)
    monkeypatch.setenv("PATH", f"{program.parent}{os.pathsep}{os.environ['PATH']}")
    folder = tmp_path / "root"
    folder.mkdir()
    return folder


def test_exit_code_of_the_root_passes_through(root, tmp_path):
    def code(script: str) -> int:
        return bubblewrap.run_in_root(root, ["sh", "-c", script], os.environ, tmp_path, ())

    assert code("exit 7") == 7
    assert code("kill -TERM $$") == 128 + signal.SIGTERM


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_signal_reaches_the_program_in_the_root(root, tmp_path, number):
    caught = "import signal, sys, time; signal.signal({0}, lambda *_: sys.exit(5)); print(flush=True)\n"
    caught += "while True: time.sleep(0.05)"
    program = [sys.executable, "-c", caught.format(int(number))]
    script = (
        f"import os, sys; sys.path.insert(0, {str(LAUNCHER)!r}); import bubblewrap; from pathlib import Path\n"
        f"sys.exit(bubblewrap.run_in_root(Path({str(root)!r}), {program!r}, os.environ, Path({str(tmp_path)!r}), ()))"
    )
    launcher = subprocess.Popen([sys.executable, "-c", script], stdout=subprocess.PIPE, start_new_session=True)
    try:
        launcher.stdout.readline()
        launcher.send_signal(number)
        assert launcher.wait(timeout=20) == 5
    finally:
        with contextlib.suppress(ProcessLookupError):
            os.killpg(launcher.pid, signal.SIGKILL)
