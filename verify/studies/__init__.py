"""Sweeps over many runs: cost, scaling, effects, hard cases."""
