"""The errors that PackCell raises on purpose: what was given, what is allowed, where to change it."""

from __future__ import annotations


class PackError(Exception):
    """A foreseeable misuse; its text is fit to be shown to the user as it is."""


class ConfigError(PackError):
    """A configuration or scene file that cannot be used."""


class OrderError(PackError):
    """An order that cannot be read, or asks for what cannot be built."""


class BagError(PackError):
    """A recording that cannot be read, or lacks what was asked of it."""


class MessageError(PackError):
    """A message that must not be used: not finite, wrong size, unknown name."""
