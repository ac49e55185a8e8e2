"""Who searches: this process, others beside it, or a cluster."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

from solvers.execution.process_pool import ProcessPool
from solvers.execution.workers import InProcess, Workers, WorkersLostError
from srgc.session import NoAnswer, UsageFault


@contextmanager
def workers_for(jobs: int, cluster: str | None = None) -> Iterator[Workers]:
    """The workers of a run, which are ended with the block, however that ends.

    Raises:
        UsageFault: the cluster at that address cannot be used.
        NoAnswer: the workers were lost in the block.
    """
    workers = _made(jobs, cluster)
    try:
        yield workers
    except WorkersLostError as error:
        raise NoAnswer(str(error)) from error
    finally:
        workers.close()


def _made(jobs: int, cluster: str | None) -> Workers:
    if cluster is None:
        return InProcess() if jobs == 1 else ProcessPool(jobs)
    from solvers.execution.dask_cluster import ClusterFault, join_cluster

    try:
        return join_cluster(cluster)
    except ClusterFault as fault:
        raise UsageFault(str(fault)) from None
