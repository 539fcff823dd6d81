"""python_module.py SCRATCH: the installed module: doctests, arrays without copies, errors, threads, what it costs."""
import doctest
import gc
import importlib
import os
import shutil
import subprocess
import sys
import threading
import time
import unittest

import numpy as np

import heartgen

SCRATCH = sys.argv.pop(1)


def ball() -> np.ndarray:
    k, j, i = np.mgrid[-10:11, -10:11, -10:11]
    return np.where(k**2 + j**2 + i**2 < 60, 1, 17).astype(np.uint8)


class Module(unittest.TestCase):
    def test_doctests(self):
        for name in ("heartgen", "heartgen.images", "heartgen.meshes", "heartgen.bundles"):
            module = importlib.import_module(name)
            names = {"np": np, **vars(module)}
            failed, tried = doctest.testmod(module, globs=names)
            self.assertEqual(failed, 0, name)

    def test_everything_public_has_a_docstring(self):
        for name in heartgen.__all__:
            self.assertTrue(getattr(getattr(heartgen, name), "__doc__", None), name)

    def test_import_is_quick(self):
        command = [sys.executable, "-c", "import time; t = time.perf_counter(); import heartgen; print(time.perf_counter() - t)"]
        seconds = min(float(subprocess.run(command, capture_output=True, text=True, check=True).stdout) for _ in range(3))
        print(f"import heartgen: {seconds:.2f} s")
        self.assertLess(seconds, 1)  # 0.3 s on an idle machine

    def test_arrays_show_the_meshs_own_memory(self):
        mesh = heartgen.mesh_labels(ball(), edge_mm=4, torso_edge_mm=6)
        self.assertEqual(mesh.points.__array_interface__["data"], mesh.points.__array_interface__["data"])
        self.assertFalse(mesh.points.flags.owndata)
        points = mesh.points
        first = points[0].copy()
        del mesh
        gc.collect()
        np.testing.assert_array_equal(points[0], first)

    def test_geometry_goes_through_files(self):
        os.makedirs(SCRATCH, exist_ok=True)
        image = heartgen.Image(np.arange(24, dtype=np.int16).reshape(2, 3, 4), (0.5, 0.75, 2), (1, 2, 3))
        path = os.path.join(SCRATCH, "image.nrrd")
        image.write(path)
        again = heartgen.read_image(path)
        np.testing.assert_array_equal(again.array, image.array)
        self.assertEqual(tuple(again.spacing), tuple(image.spacing))
        self.assertEqual(tuple(again.origin), tuple(image.origin))
        points = heartgen.mesh_labels(heartgen.Image(ball(), origin=(100, 0, 0)), edge_mm=4, torso_edge_mm=6).points
        self.assertGreater(points[:, 0].min(), 99)

    def test_errors_say_what_to_do(self):
        with self.assertRaises(heartgen.Error) as caught:
            heartgen.filter(np.zeros((4, 4)), "perona_mallik")
        self.assertIn("perona_malik", caught.exception.remedy + caught.exception.problem)
        self.assertTrue(caught.exception.remedy)
        for call in (
            lambda: heartgen.open("no such folder"),
            lambda: heartgen.mesh_labels(ball(), edges=3),
            lambda: heartgen.mesh_labels(ball(), edge_mm="fine"),
            lambda: heartgen.Mesh([[0, 0, 0]], [[0, 1, 2, 3]]),
            lambda: heartgen.filter(np.zeros((2, 2, 2, 2)), "heat"),
            lambda: heartgen.chan_vese(np.zeros((4, 4)), np.ones((3, 3), np.uint8)),
            lambda: heartgen.build(ct="x.nii.gz", output="y", settings={"meshs": {}}),
        ):
            with self.assertRaises(heartgen.Error):
                call()

    def test_other_threads_run_meanwhile(self):
        ticks, done = [], threading.Event()

        def tick():
            while not done.is_set():
                ticks.append(time.perf_counter())
                time.sleep(0.005)

        thread = threading.Thread(target=tick)
        thread.start()
        start = time.perf_counter()
        heartgen.filter(np.random.default_rng(1).normal(size=(64, 128, 128)), "tv_l2", iterations=60)
        end = time.perf_counter()
        done.set()
        thread.join()
        during = [t for t in ticks if start < t < end]
        self.assertGreater(len(during), 0.2 * (end - start) / 0.005)

    def test_a_progress_that_raises_ends_the_build(self):
        folder = os.path.join(SCRATCH, "interrupted")
        shutil.rmtree(folder, ignore_errors=True)
        recipe = heartgen.phantom(folder, size=(48, 48, 40), spacing=(7, 7, 7.5))

        def stop(stage, share, has_ended):
            raise KeyboardInterrupt

        with self.assertRaises(KeyboardInterrupt):
            heartgen.build(recipe, output=os.path.join(SCRATCH, "never"), progress=stop)
        self.assertFalse(os.path.exists(os.path.join(SCRATCH, "never")))

    def test_meshio_vtk_and_dolfinx_take_meshes(self):
        mesh = heartgen.mesh_labels(ball(), edge_mm=4, torso_edge_mm=6)
        counts = {name: int((mesh.regions == tag).sum()) for name, tag in mesh.region_names.items()}
        try:
            import meshio

            other = mesh.to_meshio()
            self.assertIsInstance(other, meshio.Mesh)
            self.assertEqual(int((other.cell_data["region"][0] == 1).sum()), counts["lv_myocardium"])
        except ImportError as missing:
            print(missing)
        try:
            grid = mesh.to_vtk()
            self.assertEqual(grid.GetNumberOfCells(), len(mesh.cells))
            self.assertEqual(tuple(grid.GetPoint(7)), tuple(mesh.points[7]))
        except ImportError as missing:
            print(missing)
        try:
            grid, cells, facets = mesh.to_dolfinx()
            self.assertEqual(int((cells.values == 1).sum()), counts["lv_myocardium"])
            self.assertEqual(len(facets.values), len(mesh.faces))
        except ImportError as missing:
            print(missing)


unittest.main(verbosity=2)
