"""Processes that are copies of one that has used csrbf already, as multiprocessing makes them by default on Linux."""

import multiprocessing
import threading
import unittest

import numpy as np

import csrbf

PATIENCE = 60  # seconds for work that takes a fraction of one

X = np.random.default_rng(0).random((1000, 2))
VALUES = np.sin(9 * X[:, 0]) * X[:, 1]


def fitted(shift):
    return csrbf.fit(X, VALUES + shift, method="partition-of-unity")(X[:5])


@unittest.skipUnless("fork" in multiprocessing.get_all_start_methods(), "this system has no fork")
class Fork(unittest.TestCase):
    def test_the_children_of_a_pool_fit_as_their_parent_does(self):
        expected = [fitted(shift) for shift in range(4)]
        with multiprocessing.get_context("fork").Pool(2) as pool:
            values = pool.map_async(fitted, range(4)).get(PATIENCE)
        np.testing.assert_array_equal(values, expected)
        np.testing.assert_array_equal(fitted(0), expected[0])

    def test_so_does_the_child_of_a_child(self):
        def child(connection):
            fitted(0)
            grandchild = fork.Process(target=lambda: connection.send(fitted(1)))
            grandchild.start()
            grandchild.join(PATIENCE)

        fork = multiprocessing.get_context("fork")
        expected = fitted(1)
        receiver, sender = fork.Pipe(duplex=False)
        process = fork.Process(target=child, args=(sender,))
        process.start()
        try:
            self.assertTrue(receiver.poll(PATIENCE))
            np.testing.assert_array_equal(receiver.recv(), expected)
            process.join(PATIENCE)
            self.assertEqual(process.exitcode, 0)
        finally:
            process.kill()

    def test_so_do_children_made_while_a_thread_computes(self):
        expected = fitted(0)
        stop = threading.Event()

        def work():
            while not stop.is_set():
                fitted(1)

        thread = threading.Thread(target=work)
        thread.start()
        try:
            for _ in range(3):
                with multiprocessing.get_context("fork").Pool(1) as pool:
                    np.testing.assert_array_equal(pool.apply_async(fitted, (0,)).get(PATIENCE), expected)
        finally:
            stop.set()
            thread.join(PATIENCE)


if __name__ == "__main__":
    unittest.main()
