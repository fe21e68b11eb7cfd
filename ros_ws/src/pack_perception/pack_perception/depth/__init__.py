"""Objects from depth images: what is where at a look, and where it goes while it is pushed."""
