"""The figures that README and the pages of results show: what is measured, with which code, and when."""
