"""Machine code from LLVM IR, kept on disk between runs."""

import functools
import hashlib
import os
import tempfile
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import llvmlite
import llvmlite.binding as llvm

HEADER = b"cayley object 1\n"


LEVELS = {
    8: ("avx512f", "avx512bw", "avx512cd", "avx512dq", "avx512vl"),
    4: ("avx", "avx2", "bmi", "bmi2", "f16c", "fma", "lzcnt", "movbe"),
}
"""What a processor must have for vectors of so many doubles: x86-64-v4 beyond x86-64-v3, and that beyond 128 bits.

The compiled steppers (steppers.native) are built for these levels and use all of them.
Source: System V Application Binary Interface, AMD64 supplement, table 3.1.
"""


def lanes() -> int:
    """Number of doubles in a vector register of this machine."""
    return _lanes_of(_host()[1])


def _lanes_of(features: str) -> int:
    """Number of lanes for features as LLVM writes them, "+avx,-avx512f, ...": of the highest level that is complete."""
    known = {feature[1:] for feature in features.split(",") if feature.startswith("+")}
    if not known.issuperset(LEVELS[4]):
        return 2
    return 8 if known.issuperset(LEVELS[8]) else 4


def host_name() -> str:
    """Name of the processor, as the compiler calls it."""
    return _host()[0]


def host_key() -> str:
    """Text that changes with the processor and the compiler."""
    return "|".join([llvmlite.__version__, str(llvm.llvm_version_info), llvm.get_default_triple(), *_host()])


def load(names: Sequence[str], ir_of: Callable[[], str], key: str) -> tuple[tuple[int, ...], bool]:
    """Addresses of functions of one module, compiled now or loaded from the cache.

    Args:
        names: the functions.
        ir_of: called for the IR of the module when there is no good cache entry.
        key: what the code depends on besides this machine and its compiler.

    Returns: (addresses, True if they came from the cache).
    """
    digest = hashlib.sha256("\n".join([*names, key, host_key()]).encode()).hexdigest()
    path = cache_directory() / f"{digest}.o"
    code = _read(path, digest)
    cached = code is not None
    if code is None:
        code = _compile(ir_of())
        _write(path, digest, code)
    engine = _engine()
    engine.add_object_file(llvm.ObjectFileRef.from_data(code))
    engine.finalize_object()
    _ENGINES.append(engine)  # the code lives as long as its engine
    return tuple(engine.get_function_address(name) for name in names), cached


def cache_directory() -> Path:
    """Folder of compiled kernels: $CAYLEY_CACHE_DIR, else a folder in the user's cache."""
    base = os.environ.get("CAYLEY_CACHE_DIR")
    if base is None:
        base = str(Path(os.environ.get("XDG_CACHE_HOME", Path.home() / ".cache")) / "cayley")
    return Path(base)


_ENGINES: list[Any] = []


@functools.cache
def _host() -> tuple[str, str]:
    llvm.initialize_native_target()
    llvm.initialize_native_asmprinter()
    return llvm.get_host_cpu_name(), llvm.get_host_cpu_features().flatten()


def _machine() -> Any:
    name, features = _host()
    target = llvm.Target.from_default_triple()
    return target.create_target_machine(
        cpu=name, features=features, opt=3, reloc="pic", codemodel="jitdefault", jit=True
    )


def _engine() -> Any:
    return llvm.create_mcjit_compiler(llvm.parse_assembly(""), _machine())


def _compile(ir: str) -> bytes:
    machine = _machine()
    module = llvm.parse_assembly(ir)
    module.triple = llvm.get_default_triple()
    module.verify()
    options = llvm.create_pipeline_tuning_options(speed_level=2)
    options.loop_unrolling = False
    options.loop_vectorization = False
    options.slp_vectorization = False
    builder = llvm.create_pass_builder(machine, options)
    builder.getModulePassManager().run(module, builder)
    return machine.emit_object(module)


def _read(path: Path, key: str) -> bytes | None:
    """The machine code of a cache entry, or None if there is none or it is damaged or another's."""
    try:
        content = path.read_bytes()
    except OSError:
        return None
    digest, code = content[len(HEADER) : len(HEADER) + 32], content[len(HEADER) + 32 :]
    good = content.startswith(HEADER) and hashlib.sha256(key.encode() + code).digest() == digest
    return code if good else None


def _write(path: Path, key: str, code: bytes) -> None:
    """Write a cache entry as a whole or not at all; a folder that can't be written costs only the time to compile."""
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        handle, temporary = tempfile.mkstemp(dir=path.parent)
        with os.fdopen(handle, "wb") as file:
            file.write(HEADER + hashlib.sha256(key.encode() + code).digest() + code)
        os.replace(temporary, path)
    except OSError:
        return
