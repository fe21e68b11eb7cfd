"""Asynchronous model-predictive control through contact."""
