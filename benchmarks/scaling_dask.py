#!/usr/bin/python3
"""Reconstructs a surface in tiles by two workers of a Dask LocalCluster, one thread each; prints their CPU seconds.

usage: scaling_dask.py CLOUD MESH FOLDER TILE_POINTS
"""

import os
import sys

# Dask's own profiler looks at every thread 100 times a second, which is not the work that is measured.
os.environ["DASK_DISTRIBUTED__WORKER__PROFILE__INTERVAL"] = "10s"
os.environ["DASK_DISTRIBUTED__WORKER__PROFILE__CYCLE"] = "100s"
import dask.distributed as dask  # noqa: E402


def one_thread():
    import csrbf

    csrbf.set_thread_count(1)


def work(cloud, mesh, folder, tile_points):
    """What a worker does for its share."""
    import csrbf

    return lambda share: csrbf.reconstruct_tiles(cloud, mesh, tile_points, folder=folder, share=share)


def seconds(client):
    return sum(client.run(lambda: sum(os.times()[:2])).values())


def main():
    cloud, mesh, folder, tile_points = sys.argv[1:]
    with dask.LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None) as cluster:
        with dask.Client(cluster) as client:
            client.run(one_thread)
            before = seconds(client)
            client.gather(client.map(work(cloud, mesh, folder, int(tile_points)), [(0, 2), (1, 2)], pure=False))
            print(f"{seconds(client) - before:.2f}")


if __name__ == "__main__":
    main()
