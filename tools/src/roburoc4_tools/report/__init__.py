# SPDX-License-Identifier: MIT
"""What a recording shows, as figures and as one page.

figures  reads a recording once, with memory that does not grow with it
series   a value over time
plots    pictures as SVG, and the style of a page with them
page     the page, which loads nothing else
"""
