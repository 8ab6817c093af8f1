"""Law, weights and noise are device code: the compiler that CUDA programs carry with them (NVRTC) takes the headers as
they stand. No GPU is needed.
"""

from __future__ import annotations

import ctypes
import shutil
from importlib import metadata
from pathlib import Path

import pytest

CORE = Path(__file__).parent.parent.parent / "core"
SHARED = ("lane.hpp", "noise.hpp", "laws/weight.hpp", "laws/dpd.hpp", "laws/steep.hpp")

KERNEL = """\
#include "laws/steep.hpp"
#include "noise.hpp"

using namespace tether;

template <class Real, class Weight, class Noise>
__device__ void pair(Weight weight, std::uint32_t const* id, Real* out) {
    StepKey const key = step_key(7, 11, Stream::run);
    Real const noise = Noise::template draw<Real>(pair_bits(particle_word(key, id[0]) + particle_word(key, id[1])));
    DpdParameters<Real> const parameters{Real(18.75), Real(4.5), Real(42.0), Real(1.0)};
    PairForce<Real> const force = Dpd<Weight>{weight}(Pair<Real>{out[0], out[1], noise}, parameters);
    out[2] = noise;
    out[3] = force.total();
    SteepParameters<Real> const steep{parameters, Real(1.0), Real(20.0), Real(5e3)};
    out[3] += SteepDpd<Weight>{weight}(Pair<Real>{out[0], out[1], noise}, steep).total();
}

template <class Real>
__device__ void pairs(std::uint32_t const* id, Real* out) {
    pair<Real, HalfPower, UniformNoise>({}, id, out);
    pair<Real, SquarePower, UniformNoise>({}, id, out + 4);
    pair<Real, AnyPower, UniformNoise>({0.35}, id, out + 8);
    pair<Real, HalfPower, GaussianNoise>({}, id, out + 12);
}

extern "C" __global__ void all(std::uint32_t const* id, double* of_double, float* of_float) {
    pairs(id, of_double);
    pairs(id, of_float);
}
"""


def library() -> ctypes.CDLL:
    """NVRTC, from the wheel among the requirements of the tests."""
    wheel = metadata.distribution("nvidia-cuda-nvrtc-cu12")
    names = [file for file in wheel.files or () if file.name == "libnvrtc.so.12"]
    assert names, "the wheel has no libnvrtc.so.12"
    return ctypes.CDLL(str(wheel.locate_file(names[0])))


def compiled(source: str, headers: Path = CORE) -> tuple[bool, str, str]:
    """Whether the source compiles with the headers of a folder; PTX, and what the compiler says."""
    nvrtc = library()
    program = ctypes.c_void_p()
    assert nvrtc.nvrtcCreateProgram(ctypes.byref(program), source.encode(), b"all.cu", 0, None, None) == 0
    options = [b"--std=c++20", b"--include-path=" + str(headers).encode()]
    result = nvrtc.nvrtcCompileProgram(program, len(options), (ctypes.c_char_p * len(options))(*options))
    texts = []
    for name in ("PTX", "ProgramLog"):
        size = ctypes.c_size_t()
        assert getattr(nvrtc, f"nvrtcGet{name}Size")(program, ctypes.byref(size)) == 0
        text = ctypes.create_string_buffer(max(1, size.value))
        assert getattr(nvrtc, f"nvrtcGet{name}")(program, text) == 0
        texts.append(text.value.decode())
    assert nvrtc.nvrtcDestroyProgram(ctypes.byref(program)) == 0
    return result == 0, texts[0], texts[1]


def test_law_weights_and_noise_compile_as_device_code() -> None:
    """For double and float, every weight and both kinds of noise, without a word from the compiler."""
    is_compiled, ptx, said = compiled(KERNEL)
    assert (is_compiled, said.strip()) == (True, "")
    for instruction in (".entry all(", "sqrt.rn.f64", "sqrt.rn.f32", "mul.f64", "mul.f32"):
        assert instruction in ptx


def test_a_function_of_the_host_is_noticed() -> None:
    """The control: the same kernel with a call of a function that is not marked for the device."""
    calling = KERNEL.replace("{0.35}", "{0.35 * half()}")
    assert calling != KERNEL
    for mark, is_right in (("", False), ("__host__ ", False), ("__device__ ", True)):
        source = calling.replace("template", f"{mark}inline double half() {{ return 0.5; }}\n\ntemplate", 1)
        is_compiled, _, said = compiled(source)
        assert is_compiled is is_right, said
        assert is_right or "host function" in said.replace("__host__", "host")


@pytest.mark.parametrize("header", SHARED)
def test_a_mark_that_is_missing_is_noticed(tmp_path: Path, header: str) -> None:
    """The control of each header: without its marks for the device its functions are the host's."""
    for name in SHARED:
        (tmp_path / name).parent.mkdir(exist_ok=True)
        shutil.copy(CORE / name, tmp_path / name)
    assert compiled(KERNEL, tmp_path)[0]
    text = (tmp_path / header).read_text(encoding="utf-8")
    marked = text.replace("TETHER_DEVICE ", "").replace("#define TETHER_DEVICE", "#define TETHER_DEVICE ")
    assert marked != text
    (tmp_path / header).write_text(marked, encoding="utf-8")
    is_compiled, _, said = compiled(KERNEL, tmp_path)
    assert not is_compiled
    assert "host function" in said
