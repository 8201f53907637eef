"""libcosim without its worker threads, through its C and C++ functions: the fastest that it can be made to go.

Neither its C API nor its Python package lets a user choose the number of threads; the constructor of its C++ class
`fixed_step_algorithm` does, and the shared library in the wheel exports it. So one is constructed with no worker, and
its implementation (the second word of the object, after the table of virtual functions) changes places with that of one
made by the C API. Holds for the version in tests/requirements.txt; `Serial` checks that the steps were made.
"""

import ctypes

STEP = 1_000_000  # nanoseconds
CONSTRUCTOR = (
    "_ZN5cosim20fixed_step_algorithmC1ENSt6chrono8durationIlSt5ratioILl1ELl1000000000EEEESt8optionalIjE"
)


def function(library, name, result, *arguments):
    return ctypes.CFUNCTYPE(result, *arguments)((name, library))


class Serial:
    """A ring of three units like those of `masters.py`."""

    def __init__(self, path):
        from libcosimpy._internal import libcosimc
        from libcosimpy.CosimLogging import CosimLogLevel, log_output_level

        log_output_level(CosimLogLevel.ERROR)
        library = libcosimc()
        word, number, reference = ctypes.c_void_p, ctypes.c_int, ctypes.c_uint32
        make = function(library, "cosim_fixed_step_algorithm_create", word, ctypes.c_int64)
        construct = function(library, CONSTRUCTOR, None, word, ctypes.c_int64, ctypes.c_uint64)
        create = function(library, "cosim_execution_create_with_algorithm", word, ctypes.c_int64, word)
        local = function(library, "cosim_local_slave_create", word, ctypes.c_char_p, ctypes.c_char_p)
        add = function(library, "cosim_execution_add_slave", number, word, word)
        connect = function(
            library, "cosim_execution_connect_real_variables", number, word, number, reference, number, reference
        )
        observe = function(library, "cosim_last_value_observer_create", word)
        add_observer = function(library, "cosim_execution_add_observer", number, word, word)
        get = function(
            library,
            "cosim_observer_slave_get_real",
            number,
            word,
            number,
            ctypes.POINTER(reference),
            ctypes.c_size_t,
            ctypes.POINTER(ctypes.c_double),
        )
        self.step = function(library, "cosim_execution_step", number, word, ctypes.c_size_t)

        self.kept = []

        def algorithm():
            made = make(STEP)
            serial = (ctypes.c_uint64 * 2)()
            no_worker = 1 << 32  # std::optional<unsigned>: the value, then whether there is one
            construct(ctypes.addressof(serial), STEP, no_worker)
            theirs = (ctypes.c_uint64 * 2).from_address(ctypes.c_uint64.from_address(made).value)
            theirs[1], serial[1] = serial[1], theirs[1]
            self.kept.append(serial)
            return made

        def ring():
            execution = create(0, algorithm())
            index = [add(execution, local(str(path).encode(), name)) for name in (b"a", b"b", b"c")]
            for source, target in ((2, 0), (0, 1), (1, 2)):
                for out, into in zip((2, 3), (0, 1)):
                    assert connect(execution, index[source], out, index[target], into) == 0
            return execution, index[0]

        # Once with an eye on it: y2 of the nearly free unit tends to twice the step size.
        watched, first = ring()
        observer = observe()
        assert add_observer(watched, observer) == 0
        assert self.step(watched, 200) == 0
        value = ctypes.c_double()
        assert get(observer, first, ctypes.byref(reference(3)), 1, ctypes.byref(value)) == 0
        assert abs(value.value - 2e-3) < 1e-9, f"libcosim made no steps: {value.value}"
        # The ring that is measured has no observer.
        self.execution, _ = ring()
        self.run(1)

    def run(self, steps):
        assert self.step(self.execution, steps) == 0
