"""What the test of the READMEs does not run as it stands. Each row says why; a row that nothing uses is an
error, so that the list stays short."""

# (pattern of the command, what is run in its place, reason)
INSTEAD = [
    (r'^(\S*python\S* \S*scripts/animate\.py .*)$', r'\1 --every 100000',
     'two pictures instead of hundreds: half a minute each'),
    (r'^(carom run input/block/block\.inp .*)$', r'\1 --define end=2e-3',
     'three of 105 increments: a minute'),
    (r'^(carom run input/pounding_frame/frames\.inp .*)$', r'\1 --define end=0.1', 'a tenth of its time: 5 s'),
    (r'^(carom run input/two_discs/oblique\.inp .*)$', r'\1 --define end=0.4', 'a quarter of its time: 3 s'),
    (r'^(carom run input/crack/slap\.inp .*)$', r'\1 --define end=0.6', 'a fifth of its time: 3 s'),
    (r'^scripts/(demo|test|report)\.sh( .*)?$', r'bash -n scripts/\1.sh',
     'installs packages and builds: .ci/run and the tests of its parts do that'),
    (r'^scripts/fuzz\.sh( .*)?$', r'bash -n scripts/fuzz.sh', 'builds with sanitizers: .ci/run does that'),
    (r'^scripts/bench\.sh(.*)$', r'OPTIONS scripts/bench.py\1', 'minutes: the test `bench` runs it on small sizes'),
    (r'^\S*python\S* scripts/stability\.py(.*)$', r'OPTIONS scripts/stability.py\1',
     'a minute: verify_stability runs it'),
    (r'^gmsh (\S+)\.geo .*$', r'test -s \1.geo -o \1 = part', 'gmsh is optional: the tests of meshes keep what it wrote'),
    (r'^\S*python\S* (scripts/mesh_from_gmsh\.py) (.*)$', r'OPTIONS \1 \2', 'gmsh is optional, as above'),
    (r'^(sudo )?(apt-get|pip|\S+ -m pip) install .*$', r'true', 'installs packages'),
    (r'^cmake --preset (\w+) && cmake --build --preset \w+$', r'PRESET \1', 'a build: this test runs in one'),
    (r'^cmake --preset (\w+)$', r'PRESET \1', 'a build: this test runs in one'),
    (r'^cmake --install build --prefix (\S+)$', r'cmake --install BUILD --prefix \1',
     'the build at hand in the place of build/'),
    (r'^man carom$', r'test -s scripts/packaging/carom.1', 'shows an installed page: the test `packaging` formats it'),
    (r'^cd build && cpack( .*)?$', r'true', 'the test `packaging` packs and installs'),
    (r'^mpirun -n \d+ carom run (\S+)$', r'carom check \1', 'needs a build with MPI: solve_by_ranks runs it there'),
]

# (README, pattern of a heading, test that covers the blocks below it)
DELEGATED = [
    ('input/README.md', r'', 'tests/reference/reference.py'),
    ('src/README.md', r'(An element|A material|An impact method)$', 'tests/examples/build_examples.py'),
    ('src/README.md', r'', 'tests/examples/check_source_map.py'),
]
