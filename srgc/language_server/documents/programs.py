"""The programs of the open documents, each analysed once for every state of its texts."""

from __future__ import annotations

import asyncio
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import ParamSpec, TypeVar

from srgc.language_server.documents.analysis import Analysis, analyse, analyse_file
from srgc.language_server.documents.open_documents import Document, OpenDocuments
from srgc.language_server.documents.projects import Projects, specs_below

Arguments = ParamSpec("Arguments")
Result = TypeVar("Result")


@dataclass(slots=True)
class _Entry:
    """An analysis that is finished or running; ``texts`` are those of all open documents."""

    future: asyncio.Future[Analysis | None]
    texts: dict[str, str]
    disk: int


class Programs:
    """Analyses by the path of their main file.

    A single thread beside that of the protocol does all the work, since two threads would only take
    turns.  Waiting analyses of outdated texts are cancelled before they begin.
    """

    def __init__(self) -> None:
        self.documents = OpenDocuments()
        self.folders: list[Path] = []
        self._projects = Projects()
        self._entries: dict[str, _Entry] = {}
        self._roots: dict[str, tuple[object, list[str]]] = {}
        self._disk = 0
        self._worker = ThreadPoolExecutor(1, "analysis")

    def close(self) -> None:
        """End the work."""
        self._worker.shutdown(wait=False, cancel_futures=True)

    def disk_changed(self) -> None:
        """Note that files on disk have changed, or that documents were opened or closed."""
        self._disk += 1

    async def work(
        self,
        function: Callable[Arguments, Result],
        *args: Arguments.args,
        **kwargs: Arguments.kwargs,
    ) -> Result:
        """Call a function in the other thread."""
        loop = asyncio.get_running_loop()
        return await loop.run_in_executor(self._worker, partial(function, *args, **kwargs))

    # --- Which programs ------------------------------------------------------------------------

    async def roots(self, document: Document) -> list[str]:
        """The main files of the programs that a document is a part of."""
        if document.path is None:
            return [document.real]
        held = {each.real: each.includes for each in self.documents if each.path is not None}
        key = (self._disk, tuple(sorted((name, tuple(paths)) for name, paths in held.items())))
        known = self._roots.get(document.real)
        if known is None or known[0] != key:
            roots = await self.work(self._projects.roots, document.real, [*self.folders], held)
            known = self._roots[document.real] = (key, roots)
        return known[1]

    async def of(self, uri: str) -> list[Analysis]:
        """The programs that an open document is a part of; empty if it is not open."""
        document = self.documents.get(uri)
        if document is None:
            return []
        found = [await self._analysis(root) for root in await self.roots(document)]
        holding = [a for a in found if a is not None and a.number(document.real) is not None]
        if holding or self.documents.get(uri) is not document:
            return holding
        # No program that includes it can be read at present, so it is analysed alone.
        alone = await self._analysis(document.real)
        return [] if alone is None else [alone]

    async def everything(self) -> list[Analysis]:
        """The programs of all open documents and of all files in the folders."""
        names: dict[str, None] = {}
        for document in [*self.documents]:
            names.update(dict.fromkeys(await self.roots(document)))
        for folder in self.folders:
            files = await self.work(lambda top: [*specs_below(top)], folder)
            names.update(dict.fromkeys(str(path) for path in files))
        found = [await self._analysis(name) for name in names]
        return [each for each in found if each is not None]

    # --- One program ---------------------------------------------------------------------------

    def _texts(self) -> dict[str, str]:
        return {document.real: document.text for document in self.documents}

    async def _analysis(self, root: str) -> Analysis | None:
        while True:
            entry = self._entries.get(root)
            if entry is None or self._outdated(entry):
                entry = self._begin(root)
            # If one waiting request is cancelled, the others must still get the result.
            await asyncio.wait([entry.future])
            if not entry.future.cancelled():
                return entry.future.result()

    def _outdated(self, entry: _Entry) -> bool:
        if entry.disk != self._disk or entry.future.cancelled():
            return True
        now = self._texts()
        if entry.future.done():
            analysis = entry.future.result()
            places = (
                entry.texts
                if analysis is None
                else map(analysis.place, range(len(analysis.sources)))
            )
            return any(now.get(place) is not entry.texts.get(place) for place in places)
        return now != entry.texts

    def _begin(self, root: str) -> _Entry:
        old = self._entries.get(root)
        if old is not None and not old.future.done():
            old.future.cancel()
        held, encoding = self.documents.files(), self.documents.encoding
        document = next((each for each in self.documents if each.real == root), None)
        loop = asyncio.get_running_loop()
        if document is None:
            task: Callable[[], Analysis | None] = partial(analyse_file, Path(root), held, encoding)
        else:
            task = partial(analyse, root, document.text, held, encoding)
        future = loop.run_in_executor(self._worker, task)
        entry = self._entries[root] = _Entry(future, self._texts(), self._disk)
        return entry


def holding(analyses: Sequence[Analysis], place: str) -> tuple[Analysis, int] | None:
    """The first program that contains a file, with the number of the file in it."""
    for analysis in analyses:
        number = analysis.number(place)
        if number is not None:
            return analysis, number
    return None
