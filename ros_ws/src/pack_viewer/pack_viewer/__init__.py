"""A page in the browser that shows a cell, live or recorded, and lets it be operated."""
