"""Motion planning measured by itself: recorded requests, planners side by side, an independent checker."""
