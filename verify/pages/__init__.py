"""The drawing kit of all pages: style, figures, templates, words."""
