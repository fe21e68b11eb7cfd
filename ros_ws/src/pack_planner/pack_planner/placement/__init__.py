"""Where to put an object down in a partly filled container."""
