"""A report as a page of HTML."""

from __future__ import annotations

from dataclasses import dataclass
from os import PathLike
from pathlib import Path


@dataclass(frozen=True, slots=True)
class Page:
    """A page of its own, which shows itself in a frame of a notebook.

    Attributes:
        html: the whole page; it loads nothing from elsewhere.
    """

    html: str

    def save(self, path: str | PathLike[str]) -> Path:
        """Write the page to a file.

        Raises:
            SrgcError: it cannot be written.
        """
        from srgc.output_file import write_output

        write_output(Path(path), self.html)
        return Path(path)

    def __repr__(self) -> str:
        return f"<Page: {len(self.html.encode()) / 1000:.0f} kB of HTML>"

    def _repr_html_(self) -> str:
        from srgc.displays.page_frame import page_frame

        return page_frame(self.html)


def page_of(folder: Path, *, verify: bool) -> Page:
    """The report of a result folder.

    Raises:
        UsageFault: there are no results, or they have been altered.
    """
    from srgc.report.page import report_page

    return Page(report_page(folder, verify=verify))
