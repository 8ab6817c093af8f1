"""Engines: what moves the particles. cpu: C++, double precision, any number of threads."""

from tether.engines.cpu import CpuEngine, cpu_engine, default_threads, instruction_set, instruction_sets, mathematics

__all__ = ["CpuEngine", "cpu_engine", "default_threads", "instruction_set", "instruction_sets", "mathematics"]
