"""Riemannian motion policies.

Cheng et al., "RMPflow: a computational graph for automatic motion policy generation", 2018; the policies
are those of NVIDIA's Lula, as its tuning guide describes them.
"""
