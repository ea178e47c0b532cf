# SPDX-License-Identifier: MIT
"""What a recording shows, as figures and as one page.

figures  reads a recording once, with memory that does not grow with it
plots    pictures as SVG
page     the page, which loads nothing else
"""
