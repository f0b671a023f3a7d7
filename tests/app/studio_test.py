"""Asks the server of csrbf studio as its page does, and as nobody may: tokens, hosts, paths, sizes, commands, cancelling.

usage: studio_test.py PROGRAM [unittest options]

Ends with 77 (skipped) when the program was built without the studio.
"""

import gzip
import http.client
import json
import math
import os
import re
import signal
import socket
import struct
import subprocess
import sys
import tempfile
import time
import unittest

# Background jobs ignore Ctrl-C, and so do the programs they start.
signal.signal(signal.SIGINT, signal.default_int_handler)

SKIPPED = 77
PROGRAM = ""
LARGEST = 1000000  # bytes, of the studio's --largest


def sphere(n):
    golden = math.pi * (3 - math.sqrt(5))
    for i in range(n):
        z = 1 - (2 * i + 1) / n
        r = math.sqrt(1 - z * z)
        yield r * math.cos(golden * i), r * math.sin(golden * i), z


def xyz(n):
    return "".join("%.9g %.9g %.9g\n" % p for p in sphere(n))


def start(*arguments):
    """The program and its address: host:port and the path of the token."""
    studio = subprocess.Popen([PROGRAM, "studio", "--no-browser", "--largest", "1MB", *arguments],
                              stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    line = studio.stdout.readline()
    found = re.search(r"http://(127\.0\.0\.1:(\d+))(/[\w-]{32}/)", line)
    if not found:
        raise AssertionError("no address in " + repr(line) + studio.stderr.read())
    return studio, int(found.group(2)), found.group(3)


def decode(data):
    """Header and arrays of a look."""
    size, = struct.unpack_from("<I", data)
    header = json.loads(data[4:4 + size])
    at, arrays = (4 + size + 7) // 8 * 8, {}
    for array in header.get("arrays", []):
        code = {"f4": "f", "u4": "I"}[array["type"]]
        arrays[array["name"]] = struct.unpack_from("<%d%s" % (array["count"], code), data, at)
        at = (at + 4 * array["count"] + 7) // 8 * 8
    return header, arrays


class Studio(unittest.TestCase):
    arguments = ()

    def setUp(self):
        self.folder = tempfile.TemporaryDirectory(prefix="csrbf_studio_test_")
        self.addCleanup(self.folder.cleanup)
        self.write("ball.xyz", xyz(800))
        self.studio, self.port, self.path = start(*self.start_arguments())
        self.addCleanup(self.end)

    def start_arguments(self):
        return [self.name("ball.xyz")]

    def name(self, file):
        return os.path.join(self.folder.name, file)

    def write(self, file, text):
        with open(self.name(file), "w") as out:
            out.write(text)

    def end(self):
        if self.studio.poll() is None:
            self.studio.send_signal(signal.SIGINT)
        self.studio.communicate(timeout=60)

    def ask(self, method, path, body=None, headers=None, raw_path=None):
        connection = http.client.HTTPConnection("127.0.0.1", self.port, timeout=120)
        self.addCleanup(connection.close)
        connection.request(method, raw_path or self.path + path, body, headers or {})
        answer = connection.getresponse()
        return answer.status, answer.read()

    def json(self, method, path, body=None, headers=None):
        status, data = self.ask(method, path, body, headers)
        self.assertEqual(status, 200, data)
        return json.loads(data)

    def refused(self, status, message, *arguments, **more):
        found, data = self.ask(*arguments, **more)
        self.assertEqual(found, status, data)
        self.assertIn(message, json.loads(data)["error"])

    def run_command(self, command, *args, preview=False):
        """The last event of a command."""
        status, data = self.ask("POST", "api/run", json.dumps({"command": command, "args": args, "preview": preview}))
        self.assertEqual(status, 200, data)
        events = re.findall(r"event: (\w+)\ndata: (.*)\n", data.decode())
        self.assertEqual(events[-1][0], "done", data)
        self.events = [name for name, _ in events]
        return json.loads(events[-1][1])


class Access(Studio):
    def test_without_the_token_nothing_is_answered(self):
        for path in ("/", "/api/session", self.path[:-2] + "/", "/" + "a" * 32 + "/api/session", "//", "/x" + self.path):
            self.refused(403, "token", "GET", "", raw_path=path)
        self.refused(403, "token", "POST", "", b"{}", raw_path="/api/run")

    def test_other_hosts_are_refused(self):
        for host in ("evil.example:%d" % self.port, "127.0.0.1", "127.0.0.1:1", "localhost.evil.example", ""):
            self.refused(403, "only pages of this studio", "GET", "api/session", headers={"Host": host})
        self.json("GET", "api/session", headers={"Host": "localhost:%d" % self.port})

    def test_other_origins_are_refused(self):
        for header in ({"Origin": "http://evil.example"}, {"Origin": "null"}, {"Sec-Fetch-Site": "cross-site"},
                       {"Origin": "http://127.0.0.1:1"}, {"Sec-Fetch-Site": "same-site"}):
            self.refused(403, "only pages of this studio", "POST", "api/run", b"{}", headers=header)
        self.json("GET", "api/session", headers={"Origin": "http://127.0.0.1:%d" % self.port,
                                                 "Sec-Fetch-Site": "same-origin"})

    def test_it_listens_on_this_machine_only(self):
        others = {a[4][0] for a in socket.getaddrinfo(socket.gethostname(), None, socket.AF_INET)} - {"127.0.0.1"}
        for address in others:
            with self.assertRaises(OSError):
                socket.create_connection((address, self.port), timeout=2).close()

    def test_the_page_loads_nothing_from_elsewhere(self):
        status, page = self.ask("GET", "")
        self.assertEqual(status, 200)
        self.assertIn(b"<title>csrbf studio</title>", page)
        self.assertNotRegex(page, rb"(src|href)=\"(?!data:)")

    def test_a_second_studio_says_that_the_port_is_taken(self):
        run = subprocess.run([PROGRAM, "studio", "--no-browser", "--port", str(self.port)], capture_output=True,
                             text=True, timeout=60)
        self.assertEqual(run.returncode, 2)
        self.assertIn("--port %d: it is in use" % self.port, run.stderr)

    def test_ctrl_c_ends_it_and_removes_its_files(self):
        before = set(os.listdir(tempfile.gettempdir()))
        self.assertTrue(any(name.startswith("csrbf-studio-") for name in before))
        self.studio.send_signal(signal.SIGINT)
        self.assertEqual(self.studio.wait(timeout=30), 0)


class Files(Studio):
    def test_paths_lead_nowhere_else(self):
        self.write("secret.txt", "1 2 3\n")
        for path in ("../secret.txt", "%2e%2e%2fsecret.txt", "..%2fsecret.txt", "%2fetc%2fpasswd", ".hidden", "a%5cb",
                     "..", "preview:..%2f..%2fsecret.txt"):
            for method, place in (("GET", "api/files/"), ("GET", "api/look/"), ("PUT", "api/files/"),
                                  ("DELETE", "api/files/")):
                status, data = self.ask(method, place + path, b"x" if method == "PUT" else None)
                self.assertIn(status, (400, 404), (method, path, data))
        self.refused(404, "no \"secret.txt\"", "GET", "api/files/secret.txt")
        with open(self.name("secret.txt")) as file:
            self.assertEqual(file.read(), "1 2 3\n")

    def test_arguments_of_commands_lead_nowhere_else(self):
        secret = self.name("secret.xyz")
        self.write("secret.xyz", xyz(50))
        for args in ([secret, "-o", "a.ply"], ["../ball.xyz", "-o", "a.ply"], ["ball.xyz", "-o", self.name("a.ply")],
                     ["ball.xyz", "-o", "a.ply", "--model=" + secret], ["ball.xyz", "-o../a.ply"],
                     ["ball.xyz", "-o" + self.name("a.ply")],
                     ["ball.xyz", "-o", "a.ply", "--report", "x/../../b.json"], ["~/a.xyz", "-o", "a.ply"]):
            self.refused(400, "out of the studio's folder", "POST", "api/run",
                         json.dumps({"command": "reconstruct", "args": args}))
        for body in ('{"command": "--version", "args": []}', '{"command": "studio", "args": []}', "[]", "{", "",
                     '{"command": "info"}', '{"command": "info", "args": [1]}',
                     '{"command": "info", "args": ["ball.xyz", "--job", "x"]}'):
            status, data = self.ask("POST", "api/run", body)
            self.assertEqual(status, 400, (body, data))
        self.assertEqual(sorted(os.listdir(self.folder.name)), ["ball.xyz", "secret.xyz"])

    def test_too_large_files_are_refused(self):
        # The size is announced only: the server answers before all of it is sent, and a client may not see that answer.
        self.refused(413, "is larger than", "PUT", "api/files/large.xyz", headers={"Content-Length": str(LARGEST + 1)})
        self.refused(404, "large.xyz", "GET", "api/files/large.xyz")

    def test_a_file_that_breaks_off_leaves_nothing(self):
        with socket.create_connection(("127.0.0.1", self.port)) as connection:
            connection.sendall(("PUT %sapi/files/part.xyz HTTP/1.1\r\nHost: 127.0.0.1:%d\r\nContent-Length: 1000\r\n\r\n"
                                "1 2 3\n" % (self.path, self.port)).encode())
        time.sleep(0.5)
        self.refused(404, "part.xyz", "GET", "api/files/part.xyz")
        self.assertNotIn("part.xyz", [f["name"] for f in self.json("GET", "api/session")["files"]])

    def test_files_are_kept_listed_looked_at_and_removed(self):
        item = self.json("PUT", "api/files/s.csv", b"x,y,depth\n0,0,1\n1,0,2\n0,1,na\n")
        self.assertEqual((item["name"], item["kind"], item["made"]), ("s.csv", "table", True))
        header, arrays = decode(self.ask("GET", "api/look/s.csv")[1])
        self.assertEqual([c["name"] for c in header["columns"]], ["x", "y", "depth"])
        self.assertEqual(arrays["column2"][:2], (1, 2))
        self.assertTrue(math.isnan(arrays["column2"][2]))
        self.assertEqual([header[key] for key in ("separator", "firstLine", "namesInComment")], [",", 2, False])
        self.json("PUT", "api/files/remark.csv", b"# by hand\n# x; y; v\n0;0;1\n1;0;2\n")
        header, _ = decode(self.ask("GET", "api/look/remark.csv")[1])
        self.assertEqual([header[key] for key in ("separator", "firstLine", "namesInComment")], [";", 3, True])
        self.json("DELETE", "api/files/remark.csv")
        again = self.json("PUT", "api/files/s.csv", b"1,2,3\n")
        self.assertEqual(again["name"], "s-2.csv")
        self.json("DELETE", "api/files/s.csv")
        self.assertEqual([f["name"] for f in self.json("GET", "api/session")["files"]], ["ball.xyz", "s-2.csv"])
        broken = self.json("PUT", "api/files/broken.ply", b"no mesh")
        self.assertEqual(broken["kind"], "other")
        self.assertIn("broken.ply", broken["problem"])

    def test_columns_tell_scans_from_values_at_places(self):
        for names, kind in (("x,y,z", "points"), ("X,Y,Z,Intensity", "points"), ("x,y,z,r,g,b", "points"),
                            ("x,y,z,nx,ny,nz,residual", "points"), ("x,y,z,temperature", "table"), ("x,y,depth", "table")):
            with self.subTest(names=names):
                row = ",".join("1" for _ in names.split(",")) + "\n"
                name = self.json("PUT", "api/files/columns.csv", (names + "\n" + 3 * row).encode())["name"]
                self.assertEqual(decode(self.ask("GET", f"api/look/{name}")[1])[0]["kind"], kind)
                self.json("DELETE", f"api/files/{name}")

    def test_what_scanners_write_is_shown_compressed_or_not(self):
        places = [(i % 5, i // 5, i % 3) for i in range(20)]
        lines = "".join("%d %d %d\n" % p for p in places)
        pcd = ("VERSION .7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH 20\nHEIGHT 1\n"
               "VIEWPOINT 0 0 0 1 0 0 0\nPOINTS 20\nDATA ascii\n")
        las = (b"LASF" + bytes(20) + bytes([1, 2]) + bytes(68) + struct.pack("<HIIBHI5I", 227, 227, 0, 0, 20, 20, 20, 0, 0, 0, 0) +
               struct.pack("<12d", *[1.0] * 3, *[0.0] * 3, 4, 0, 3, 0, 2, 0) +
               b"".join(struct.pack("<3i8x", *p) for p in places))
        table = "x,y,depth\n" + lines.replace(" ", ",")
        for name, data, kind in (("s.las", las, "points"), ("s.pcd", (pcd + lines).encode(), "points"),
                                 ("s.off", ("OFF\n20 0 0\n" + lines).encode(), "points"),
                                 ("s.xyz.gz", gzip.compress(lines.encode()), "points"),
                                 ("s.csv.gz", gzip.compress(table.encode()), "table")):
            with self.subTest(name=name):
                item = self.json("PUT", f"api/files/{name}", data)
                self.assertEqual(item["kind"], kind, item)
                self.assertEqual(decode(self.ask("GET", f"api/look/{name}")[1])[0]["total"], 20)
                self.json("DELETE", f"api/files/{name}")

    def test_points_and_slices_are_sent_as_numbers(self):
        header, arrays = decode(self.ask("GET", "api/look/ball.xyz?most=100")[1])
        self.assertEqual((header["kind"], header["total"], len(arrays["positions"])), ("points", 800, 300))
        voxels = struct.pack("<24h", *range(24))
        mha = b"ObjectType = Image\nNDims = 3\nDimSize = 4 3 2\nElementSpacing = 1 2 3\nElementType = MET_SHORT\nElementDataFile = LOCAL\n"
        self.json("PUT", "api/files/v.mha", mha + voxels)
        header, _ = decode(self.ask("GET", "api/look/v.mha")[1] )
        self.assertEqual((header["kind"], header["size"], header["spacing"], header["range"]),
                         ("volume", [4, 3, 2], [1, 2, 3], [0, 23]))
        header, arrays = decode(self.ask("GET", "api/look/v.mha?axis=0&index=1")[1])
        self.assertEqual((header["width"], header["height"]), (3, 2))
        self.assertEqual(arrays["values"], (1, 5, 9, 13, 17, 21))
        for query in ("axis=3&index=0", "axis=0&index=4", "axis=0&index=-1", "axis=x&index=0"):
            self.assertEqual(self.ask("GET", "api/look/v.mha?" + query)[0], 400)

    def test_what_the_user_had_is_neither_replaced_nor_removed(self):
        self.refused(409, "was there before", "POST", "api/run",
                     json.dumps({"command": "estimate-normals", "args": ["ball.xyz", "-o", "ball.xyz"]}))
        self.refused(409, "was there before", "PUT", "api/files/ball.xyz?replace=1", b"1 2 3\n")
        self.json("DELETE", "api/files/ball.xyz")
        self.assertTrue(os.path.exists(self.name("ball.xyz")))


class Commands(Studio):
    def test_the_options_are_those_of_the_program(self):
        commands = {c["name"]: c for c in self.json("GET", "api/commands")}
        self.assertLess({"reconstruct", "fit", "segment", "studio"}, set(commands))
        flags = {f["name"]: f for f in commands["reconstruct"]["flags"]}
        self.assertEqual(flags["--smoothing"]["words"], ["auto", "none"])
        self.assertEqual((flags["--sharp"]["onlyWords"], flags["--sharp"]["words"]), (True, ["auto", "on", "off"]))
        self.assertTrue(flags["--threads"]["common"])
        self.assertNotIn("--job", flags)

    def test_a_surface_is_reconstructed(self):
        done = self.run_command("reconstruct", "ball.xyz", "-o", "ball.ply", "--model", "ball.csrbf", "--report",
                                "ball.html", "--resolution", "24")
        self.assertEqual(done["status"], 0, done)
        self.assertIn("progress", self.events)
        self.assertEqual({i["name"]: i["kind"] for i in done["items"]},
                         {"ball.ply": "mesh", "ball.csrbf": "surface", "ball.html": "other"})
        self.assertTrue(done["report"]["result"]["watertight"])
        self.assertEqual(done["report"]["options"]["resolution"], 24)
        header, arrays = decode(self.ask("GET", "api/look/ball.ply")[1])
        self.assertEqual(3 * done["report"]["result"]["triangles"], len(arrays["triangles"]))
        center = [0.5 * (a + b) for a, b in zip(header["low"], header["high"])]
        for i in range(0, len(arrays["positions"]), 300):
            place = [arrays["positions"][i + a] + center[a] for a in range(3)]
            self.assertAlmostEqual(math.hypot(*place), 1, delta=0.05)
        page = self.ask("GET", "api/files/ball.html")[1].decode()
        self.assertIn("csrbf reconstruct ball.xyz -o ball.ply --model ball.csrbf --report ball.html --resolution 24",
                      page)
        self.assertNotIn("--job", page)
        # The same as on the command line.
        subprocess.run([PROGRAM, "reconstruct", self.name("ball.xyz"), "-o", self.name("ball.ply"), "--resolution",
                        "24", "-q"], check=True, timeout=120)
        with open(self.name("ball.ply"), "rb") as file:
            self.assertEqual(file.read(), self.ask("GET", "api/files/ball.ply")[1])

    def test_frames_are_tracked_and_their_labels_can_be_asked_for(self):
        n, frames = 16, 3
        values = [100 if math.dist((x, y), (5 + 2 * t, 8)) < 4 else 10 for t in range(frames) for y in range(n)
                  for x in range(n)]
        head = f"ObjectType = Image\nNDims = 3\nDimSize = {n} {n} {frames}\nElementType = MET_SHORT\n"
        head += "ElementDataFile = LOCAL\n"
        self.json("PUT", "api/files/movie.mha", head.encode() + struct.pack("<%dh" % len(values), *values))
        done = self.run_command("track", "movie.mha", "-o", "movie-track", "--slices-are-frames", "--report",
                                "movie.html")
        self.assertEqual(done["status"], 0, done)
        kinds = {i["name"]: i["kind"] for i in done["items"]}
        self.assertEqual(kinds, {**{"movie-track/labels_%04d.mha" % t: "volume" for t in range(frames)},
                                 "movie-track/measures.csv": "table", "movie.html": "other"})
        for t in range(frames):
            header, arrays = decode(self.ask("GET", "api/look/movie-track%%2flabels_%04d.mha?axis=2&index=0" % t)[1])
            self.assertEqual((header["width"], header["height"]), (n, n))
            self.assertEqual([arrays["values"][8 * n + x] for x in (5 + 2 * t, 15)], [1, 0])
        self.assertIn(b"frame,region", self.ask("GET", "api/files/movie-track%2fmeasures.csv")[1])
        for path in ("movie-track%2f..%2fmovie.mha", "movie-track%2fmodels%2fframe_0000.csrbf", "movie-track",
                     "movie-track%2f.hidden", "%2fmovie.mha"):
            self.assertIn(self.ask("GET", "api/files/" + path)[0], (400, 404), path)
        self.refused(409, "was there before", "POST", "api/run", json.dumps(
            {"command": "track", "args": ["movie.mha", "-o", "movie-track", "--slices-are-frames"]}))

    def test_frames_of_an_image_with_a_time_axis_are_sent(self):
        nii = bytearray(352)
        struct.pack_into("<i", nii, 0, 348)
        struct.pack_into("<8h", nii, 40, 4, 3, 2, 1, 2, 1, 1, 1)
        struct.pack_into("<2h", nii, 70, 4, 16)  # short
        struct.pack_into("<8f", nii, 76, 1, 1, 1, 1, 1, 0, 0, 0)
        struct.pack_into("<2f", nii, 108, 352, 1)
        nii[344:348] = b"n+1\0"
        self.json("PUT", "api/files/t.nii", bytes(nii) + struct.pack("<12h", *range(12)))
        header, _ = decode(self.ask("GET", "api/look/t.nii")[1])
        self.assertEqual(header["frames"], 2)
        for frame, first in ((0, 0), (1, 6)):
            _, arrays = decode(self.ask("GET", "api/look/t.nii?axis=2&index=0&frame=%d" % frame)[1])
            self.assertEqual(arrays["values"], tuple(range(first, first + 6)))
        self.assertEqual(self.ask("GET", "api/look/t.nii?axis=2&index=0&frame=2")[0], 400)

    def test_previews_run_on_few_samples_and_are_not_listed(self):
        self.json("PUT", "api/files/many.xyz", xyz(4000).encode()[:LARGEST].rsplit(b"\n", 1)[0])
        done = self.run_command("reconstruct", "many.xyz", "-o", "many.ply", preview=True)
        self.assertEqual(done["status"], 0, done)
        self.assertEqual([i["name"] for i in done["items"] if i["name"].endswith(".ply") and "xyz" not in i["name"]],
                         ["preview:many.ply"])
        self.assertLessEqual(done["report"]["input"]["points"], 3000)
        self.assertEqual(decode(self.ask("GET", "api/look/preview:many.ply")[1])[0]["kind"], "mesh")
        self.assertEqual([f["name"] for f in self.json("GET", "api/session")["files"]], ["ball.xyz", "many.xyz"])

    def test_what_the_program_says_arrives(self):
        done = self.run_command("reconstruct", "ball.xyz", "-o", "ball.pdf")
        self.assertEqual(done["status"], 2)
        self.assertIn('unknown extension ".pdf"', done["error"])
        self.assertNotIn("items", [k for k in done if done[k]])
        done = self.run_command("reconstruct", "ball.xyz", "-o", "a.ply", "--smoothin", "1")
        self.assertIn("--smoothing", done["error"])

    def test_closing_the_connection_ends_the_command(self):
        # Interpolating 3000 samples with every kernel takes many seconds.
        rows = "".join("%g,%g,%g\n" % (math.sin(i), math.cos(2.3 * i), math.sin(0.7 * i)) for i in range(3000))
        self.json("PUT", "api/files/long.csv", rows.encode())
        body = json.dumps({"command": "fit", "args": ["long.csv", "-o", "long.csrbf", "--method", "interpolate",
                                                      "--kernel", "thin-plate", "--loss", "student"]})
        with socket.create_connection(("127.0.0.1", self.port), timeout=60) as connection:
            head = "POST %sapi/run HTTP/1.1\r\nHost: 127.0.0.1:%d\r\nContent-Length: %d\r\n\r\n"
            connection.sendall((head % (self.path, self.port, len(body)) + body).encode())
            heard = b""
            while b"event: progress" not in heard:
                heard += connection.recv(4096)
            self.assertTrue(self.children())
        ended = time.monotonic() + 20
        while self.children() and time.monotonic() < ended:
            time.sleep(0.05)
        self.assertEqual(self.children(), [])
        self.assertNotIn("long.csrbf", [f["name"] for f in self.json("GET", "api/session")["files"]])
        self.assertEqual(self.run_command("info", "ball.xyz")["status"], 0)  # there is room for another one

    def children(self):
        """Processes that the studio started."""
        with open("/proc/%d/task/%d/children" % (self.studio.pid, self.studio.pid)) as file:
            own = file.read().split()
        for task in os.listdir("/proc/%d/task" % self.studio.pid):
            with open("/proc/%d/task/%s/children" % (self.studio.pid, task)) as file:
                own += file.read().split()
        return sorted(set(own))


class OwnFolder(Studio):
    def start_arguments(self):
        self.write("points.xyz", xyz(300))
        os.symlink("/etc/passwd", self.name("link.txt"))
        return ["--folder", self.folder.name]

    def test_results_stay_there(self):
        self.assertEqual({"ball.xyz", "points.xyz"}, {f["name"] for f in self.json("GET", "api/session")["files"]})
        self.assertEqual(self.run_command("reconstruct", "ball.xyz", "-o", "ball.ply", "--resolution", "16")["status"], 0)
        self.assertTrue(os.path.exists(self.name("ball.ply")))

    def test_links_do_not_lead_out(self):
        self.refused(400, "out of the studio's folder", "POST", "api/run",
                     json.dumps({"command": "info", "args": ["link.txt"]}))
        for place in ("api/files/link.txt", "api/look/link.txt"):
            self.assertIn(self.ask("GET", place)[0], (400, 404))

    def test_files_from_elsewhere_are_refused(self):
        with tempfile.NamedTemporaryFile(suffix=".xyz") as file:
            run = subprocess.run([PROGRAM, "studio", file.name, "--folder", self.folder.name, "--no-browser"],
                                 capture_output=True, text=True, timeout=60)
        self.assertEqual(run.returncode, 2)
        self.assertIn("is not in --folder", run.stderr)


if __name__ == "__main__":
    PROGRAM = os.path.abspath(sys.argv.pop(1))
    probe = subprocess.Popen([PROGRAM, "studio", "--no-browser"], stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                             text=True)
    first = probe.stdout.readline()
    probe.send_signal(signal.SIGINT)
    said = probe.communicate(timeout=60)[1]
    if not first and "built without the studio" in said:
        print("skipped: " + said)
        sys.exit(SKIPPED)
    unittest.main(verbosity=2)
