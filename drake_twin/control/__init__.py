"""Calculations of controllers: plain values in, plain values out, without Drake and without messages."""
