"""What may stand in a deck: values that parameters take, numbers at the ends of their range."""

# keyword: parameter: values; None is a parameter without a value, '' takes the parameter away
PARAMETERS = {
    "SOLIDSECTION": {"ELEMENTS": ["CPE", "CPS", "CAX", ""], "BBAR": ["YES", "NO", ""]},
    "PLASTIC": {"HARDENING": ["ISOTROPIC", "KINEMATIC", "COMBINED", ""]},
    "SPRING": {"NONLINEAR": [None, ""]},
    "ELEMENTGROUP": {"SCHEME": ["IMPLICIT", "EXPLICIT", "AUTO"],
                     "MASS": ["LUMPED", "CONSISTENT", ""]},
    "AMPLITUDE": {"TIME": ["STEP TIME", "TOTAL TIME", ""]},
    "BOUNDARY": {"TYPE": ["DISPLACEMENT", "VELOCITY", "ACCELERATION", ""],
                 "OP": ["MOD", "NEW", ""]},
    "BASEMOTION": {"DOF": ["1", "2", "3"]},
    "INITIALCONDITIONS": {"TYPE": ["DISPLACEMENT", "VELOCITY"]},
    "SURFACE": {"TYPE": ["ELEMENT", "NODE", ""]},
    "RIGIDSURFACE": {"TYPE": ["PLANE", "CIRCLE"]},
    "IMPACT": {"METHOD": ["TRANSFORMATION", "FICTITIOUS FORCE", "PENALTY", "LAGRANGE", ""],
               "RESTITUTION": ["0", "0.5", "1", "1e-12", "0.999999999", ""],
               "RETURN": ["0.3", "0.999", "1e-9", ""], "SOLUTION": ["ITERATION", "DIRECT", ""],
               "BETA": ["0", "1/4", "1/6", "0.5", "AUTO", ""],
               "CAPTURE": ["0", "1e-12", "1", "1e12", ""],
               "MAX EVENTS": ["0", "1", "2", "1000000000", ""],
               "EVENTS": ["SUBSTEP", "ANCHOR", ""],
               "STIFFNESS": ["1", "1e-12", "1e6", "1e12", "1e300", ""]},
    "CONTACTPAIR": {"TYPE": ["NODE TO SURFACE", "SURFACE TO SURFACE", ""],
                    "PASSES": ["1", "2", ""], "MASS": ["REDISTRIBUTED", ""],
                    "ADJUST": [None, "0", "0.1", "1e9", ""], "SMALL SLIDING": [None, ""]},
    "STEP": {"INC": ["1", "10", "1000000", "2147483647", ""], "NLGEOM": [None, "NO", "YES", ""],
             "PERTURBATION": [None, ""], "NAME": ["one", ""]},
    "STATIC": {"DIRECT": [None, ""], "SOLVER": ["AUTO", "SKYLINE", "MUMPS", ""]},
    "DYNAMIC": {"DIRECT": [None, ""], "EXPLICIT": [None, ""], "ORDER": ["2", "4", ""],
                "TOLERANCE": ["1e-1", "1e-3", "1e-6", "1", "1e-15", ""],
                "GAMMA": ["0.5", "0.6", "1", "5", "1e9", ""],
                "BETA": ["0", "1/12", "1/6", "1/4", "0.5", ""],
                "ALPHA": ["-1/3", "-0.1", "0", "-1e-12", ""],
                "SOLVER": ["AUTO", "SKYLINE", "MUMPS", ""]},
    "FREQUENCY": {"SOLVER": ["AUTO", "SKYLINE", "MUMPS", ""]},
    "CLOAD": {"OP": ["MOD", "NEW", ""]},
    "DLOAD": {"OP": ["MOD", "NEW", ""]},
    "NODEPRINT": {"FREQUENCY": ["1", "3", "1000000", ""], "TOTALS": ["YES", ""]},
    "NODEFILE": {"FREQUENCY": ["1", "3", "1000000", ""], "OUTPUT": ["2D", ""]},
    "ELPRINT": {"FREQUENCY": ["1", "3", "1000000", ""]},
    "ELFILE": {"FREQUENCY": ["1", "3", "1000000", ""]},
    "CONTACTPRINT": {"FREQUENCY": ["1", "3", ""]},
    "CONTACTFILE": {"FREQUENCY": ["1", "3", ""]},
    "ENERGYPRINT": {"FREQUENCY": ["1", "3", ""], "LIMIT": ["1e-6", "1", "1e-300", ""]},
    "RESTART": {"WRITE": [None, ""], "FREQUENCY": ["1", "3", "2147483647", ""]},
    "OUTPUT": {"COMPRESS": ["1", "9", ""]},
}

# Parameters whose value names something: keyword and parameter of the card that defines it
REFERENCES = {
    "ELSET": [("ELEMENT", "ELSET"), ("ELSET", "ELSET")],
    "NSET": [("NODE", "NSET"), ("NSET", "NSET")],
    "MATERIAL": [("MATERIAL", "NAME")],
    "AMPLITUDE": [("AMPLITUDE", "NAME")],
    "INTERACTION": [("SURFACEINTERACTION", "NAME")],
}

# Types of elements with the same number of nodes
ELEMENT_TYPES = [
    ["CPE3", "CPS3", "CAX3", "T2D3", "T3D3"],
    ["CPE4", "CPS4", "CAX4", "CPE4R", "CPS4R", "CAX4R"],
    ["CPE6", "CPS6", "CAX6"],
    ["CPE8", "CPS8", "CAX8", "CPE8R", "CPS8R", "CAX8R"],
    ["T2D2", "T3D2", "SPRING2", "SPRINGA", "DASHPOT2", "DASHPOTA", "GAPUNI"],
    ["MASS", "SPRING1", "DASHPOT1"],
]

REQUESTED = {
    "NODEPRINT": ["U", "V", "A", "RF"], "NODEFILE": ["U", "V", "A", "RF"],
    "ELPRINT": ["S", "E", "PEEQ", "ENER"], "ELFILE": ["S", "E", "PEEQ", "ENER"],
    "CONTACTPRINT": ["CF", "CDIS", "CPRESS", "CSTR", "CSLIP", "CSTATE"],
    "CONTACTFILE": ["CF", "CDIS", "CPRESS", "CSTR", "CSLIP", "CSTATE"],
}

# Numbers that a reader may stumble over
ODD_NUMBERS = [
    "0", "-1", "1", "-0", "-0.0", "2", "3", "4", "0.5", "1e-300", "1e-15", "1e15", "1e155", "1e300",
    "1e308", "1.7976931348623157e308", "1.7976931348623159e308", "1e400", "-1e400", "-1e308",
    "nan", "NaN", "-nan", "inf", "-inf", "+Infinity", "0x10", "0x1p3", "1d3", "1.D+3", "1D-5",
    "1d308", "1e", "1e+", "e5", ".", "+", "-", "--1", "1.5.2", "1_000", "1,5", "1 2", "1e5e5",
    "2147483647", "2147483648", "-2147483648", "-2147483649", "4294967295", "4294967296",
    "4294967297", "9223372036854775807", "9223372036854775808", "18446744073709551617",
    "1e-320", "5e-324", "4.9e-324", "1e-400", "1e2147483647", "1e-2147483648", "1e99999999999",
    "1" + "0"*400, "0." + "0"*400 + "1", "3." + "14159265358979"*8, "0"*300 + "1", "1/6", "1/0",
    "0/0", "1/", "/6", "1/3/5", "1e308/1e-308", "*", "1*3", "\"1\"", "'1'", "", " ", "<dt>",
    "<nothing>", "<", ">", "<>", "<dt", "dt>", "<<dt>>", "T", ".TRUE.", "1\xa02", "\xef\xbc\x91",
    "0b1", "1f", "1.0L", "1e0.5", "1'000", "O'7'", "(1,2)", "1;2", "%d", "%s%n",
]

# Text in the places of names
ODD_NAMES = [
    "", " ", "x"*79, "x"*80, "x"*81, "x"*10000, "1", "0", "-1", "a b", "\"a\"", "'a'", "a=b", "=",
    "\xe9t\xe9", "\xff\xfe", "\xf0\x9f\x98\x80", "a/b", "../a", "a\tb", "%s", "$HOME", "<e>",
    "ALL", "NONE", "S1", "P1", "GRAV", "CENTRIF", "__", "a.b", "node_1", "VTKHDF", ".", "..",
    "a;b", "*", "**", "*NODE", "#",
]

# Files that a deck may name
ODD_FILES = [
    "deck.inp", "./deck.inp", "../deck.inp", "none.inc", "", " ", "/", ".", "..", "/dev/null",
    "/etc/hostname", "../../../../../../etc/hostname", "/proc/self/status", "\"deck.inp\"",
    "x"*300, "x"*10000, "a/"*2000 + "b", "deck.inp/deck.inp", "DECK.INP", "self.inc", "%s",
    "\xe9.inc", "file:///etc/hostname", "~/x", "$HOME/x", "/dev/full", "/dev/tty",
]

ODD_BYTES = [
    "\x00", "\r", "\t", "\n", "\r\n", "\x1a", "\x1b[2J", "\x7f", "\x80", "\xff", "\xfe\xff",
    "\xef\xbb\xbf", "\xc3", "\xe2\x80\xa8", "\xc0\xaf", "\x0b", "\x0c", "\b", " ", ",", ",,", "*",
    "**", "=", "<", ">", "/", "\"", "'", "\\", "!", "#", "-", ".", "e", "9", ";", "&", "%", "$",
]
