"""A figure that a notebook shows."""

import io

from matplotlib.figure import Figure


class NotebookFigure(Figure):
    """A figure of matplotlib that a cell of a notebook shows. IPython has matplotlib's own pictures drawn only once pyplot was
    imported and used, which none of our figures need; till then it would write a figure's name."""

    def _repr_png_(self) -> bytes:
        picture = io.BytesIO()
        self.savefig(picture, format="png")
        return picture.getvalue()
