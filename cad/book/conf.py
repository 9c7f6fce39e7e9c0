"""Configuration of the book for Sphinx. `build` makes the documents that it reads, and gives the title."""
project = "pinswitch"
root_doc = "index"
extensions = ["myst_parser", "sphinx_copybutton"]

# Anchors of headings of every level, as on the pages of the repository.
myst_heading_anchors = 6
# Blocks without a language are formulas and outputs.
highlight_language = "none"
# Pygments cannot read one script of the tests completely; its page then has fewer colours.
suppress_warnings = ["misc.highlighting_failure"]

html_theme = "furo"
html_static_path = ["static"]
html_css_files = ["book.css"]
html_copy_source = False
html_show_copyright = False
html_use_index = False
# A copied session contains its commands only, without prompts and output.
copybutton_exclude = ".linenos, .gp, .go"
