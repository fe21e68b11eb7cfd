"""Faults put into a running cell one after the other, and what becomes of it."""
