"""What every filter shares: parameters from its options, errors that reach the caller, progress and abort."""

from __future__ import annotations

import inspect
import time
from dataclasses import fields
from numbers import Integral, Real

from vtkmodules.util.vtkAlgorithm import VTKPythonAlgorithmBase
from vtkmodules.vtkCommonCore import vtkOutputWindow
from vtkmodules.vtkCommonDataModel import vtkCompositeDataSet, vtkDataObject
from vtkmodules.vtkCommonExecutionModel import (
    vtkAlgorithm,
    vtkDemandDrivenPipeline,
    vtkStreamingDemandDrivenPipeline,
)

from tetraskel.distributed.communicator import together
from tetraskel.errors import Aborted, InputError
from tetraskel.options import Options, check_value
from tetraskel.vtkfilters import ranks
from tetraskel.vtkfilters.found import count_blocks, facts_of, gathered, whole_input

PROGRESS_SECONDS = 0.1
_OWN_ATTRIBUTES = ("InputType", "OutputType")  # set by VTKPythonAlgorithmBase


def camel_case(name: str) -> str:
    """`keep_leaves` is `KeepLeaves`."""
    return "".join(word.capitalize() for word in name.split("_"))


class SkeletonFilter(VTKPythonAlgorithmBase):
    """Base of the filters.

    A subclass names its `options` and implements `execute(inputs, outputs)`. For every option it then has
    `SetName`, `GetName`, a property `name` and a keyword of the constructor. The last two raise at once for a value
    that cannot be; the setters, which ParaView calls, leave that to the execution.

    Attributes
    ----------
    last_error : Exception or None
        What went wrong in the last execution. VTK's own `Update()` does not tell; `run()` raises it.
    """

    options: type[Options] = Options
    input_type = "vtkPointSet"
    input_doc = ""
    output_type = "vtkPolyData"
    second_input = ()  # name, port, data type and meaning of an optional second input
    n_outputs = 1
    output_names = ()  # of several outputs, as a panel shows them
    drawn_as = ()  # a word for each output, see `paraview_display.LOOKS`
    tells = {}  # noqa: RUF012  (read only: what it says of its result, with the meaning, see `found.facts_of`)

    def __init_subclass__(cls, **keywords):
        super().__init_subclass__(**keywords)
        for declared in fields(cls.options):
            _declare(cls, declared)
        for fact in cls.tells:
            _declare_fact(cls, fact)
        cls.__signature__ = _signature(cls.options)

    def __init__(self, **values):
        self._values = {declared.name: declared.default for declared in fields(self.options)}
        self._shown = 0.0
        self._last_error = None
        self._found = []  # facts of each block
        self._said = set()  # errors, each printed once for all blocks
        self._blocks_left, self._is_first = 0, False
        super().__init__(
            nInputPorts=2 if self.second_input else 1,
            inputType=self.input_type,
            nOutputPorts=self.n_outputs,
            outputType=self.output_type,
        )
        self._listen_to_vtk()
        for name, value in values.items():
            setattr(self, name, value)

    def __setattr__(self, name, value):
        """Refuse names that are neither options nor VTK's own: a misspelt option must not pass silently."""
        if not name.startswith("_") and name not in _OWN_ATTRIBUTES and not hasattr(type(self), name):
            known = ", ".join(declared.name for declared in fields(self.options))
            raise AttributeError(f"{type(self).__name__} has no option {name!r}; it has: {known or 'none'}.")
        super().__setattr__(name, value)

    @property
    def last_error(self):
        """What went wrong in the last execution, or None."""
        return self._last_error

    def found(self, fact):
        """A fact of `tells` about the last result, as text; of several blocks the sum, or what all of them say."""
        return gathered(self._found, fact)

    def execute(self, inputs, outputs):
        """Fill the output data objects from the input data objects."""
        raise NotImplementedError

    def FillInputPortInformation(self, port, info):
        """Called by VTK: what each input takes; the second one may be left unconnected."""
        if port == 0:
            info.Set(vtkAlgorithm.INPUT_REQUIRED_DATA_TYPE(), self.input_type)
        else:
            info.Set(vtkAlgorithm.INPUT_REQUIRED_DATA_TYPE(), self.second_input[2])
            info.Set(vtkAlgorithm.INPUT_IS_OPTIONAL(), 1)
        return 1

    def RequestData(self, request, inInfo, outInfo):  # noqa: N803
        """Called by VTK: hand the data objects to `execute`."""
        inputs = [self._connected(vector) for vector in inInfo]
        outputs = [vtkDataObject.GetData(outInfo, port) for port in range(self.n_outputs)]
        comm = ranks.communicator_for(self)
        if comm is None:
            self.execute(inputs, outputs)
        else:
            together(comm, lambda: self.execute_on_ranks(comm, inputs, outputs))
        self._found.append(facts_of(outputs[0]))
        return 1

    def execute_on_ranks(self, comm, inputs, outputs):
        """Fill the outputs on several ranks, of which each has pieces of the inputs.

        Unless a filter can do better, the first rank gets all pieces and does the work; the others have no output.
        """
        whole = [None if data is None else ranks.gathered(comm, data) for data in inputs]
        if comm.rank == 0:
            self.execute(whole, outputs)

    def RequestInformation(self, request, inInfo, outInfo):  # noqa: N803
        """Called by VTK: on several ranks every rank takes part, whether it has a piece of the input or not."""
        for port in range(self.n_outputs):
            outInfo.GetInformationObject(port).Set(vtkAlgorithm.CAN_HANDLE_PIECE_REQUEST(), 1)
        return 1

    @staticmethod
    def _connected(vector):
        return vtkDataObject.GetData(vector, 0) if vector.GetNumberOfInformationObjects() else None

    def ProcessRequest(self, request, inInfo, outInfo):  # noqa: N803
        """Called by VTK: keep an exception for `run()`, empty the output and print one line."""
        self._listen_to_vtk()
        try:
            if request.Has(vtkDemandDrivenPipeline.REQUEST_DATA()):
                self._begin_block()
                self.options(**self._values)  # the setters ParaView calls do not raise; here the error has one line
            else:
                self._look_ahead(request)
            return super().ProcessRequest(request, inInfo, outInfo)
        except (Exception, KeyboardInterrupt) as error:  # VTK would lose an interrupt; run() raises it again
            self._last_error = self._last_error or error
            self._empty_outputs(outInfo)
            if isinstance(error, (Aborted, KeyboardInterrupt)):
                return 1
            self._print_error(error)
            return 0

    def _listen_to_vtk(self):
        """VTK's own errors are kept back: after ours they only add noise, else they become one of ours.

        Ours have been printed when VTK complains about our return value. Without one of ours VTK refused to run the
        filter at all, for an input of the wrong type or none.
        """
        for speaker in (self, self.GetExecutive()):  # ParaView exchanges the executive after construction
            if not speaker.HasObserver("ErrorEvent"):
                speaker.AddObserver("ErrorEvent", _heard)

    def _look_ahead(self, request):
        """Before an execution VTK asks with the whole input; for each block of a composite it then asks again."""
        whole = whole_input(self)
        if isinstance(whole, vtkCompositeDataSet):
            self._blocks_left, self._is_first = count_blocks(whole), True
        elif request.Has(vtkStreamingDemandDrivenPipeline.REQUEST_UPDATE_TIME()):  # not asked for a block
            self._blocks_left = 0

    def _begin_block(self):
        """Forget what was said of the last input, unless this is the next block of the same one."""
        if self._is_first or self._blocks_left == 0:
            self._last_error, self._found, self._said = None, [], set()
        self._is_first = False
        self._blocks_left = max(self._blocks_left - 1, 0)

    def _vtk_complained(self):
        if self._last_error is None:
            self._last_error = InputError(f"expected an input of type {self.input_type}, got another type or none.")
            self._print_error(self._last_error)

    def _print_error(self, error):
        if str(error) not in self._said:
            vtkOutputWindow.GetInstance().DisplayErrorText(f"{type(self).__name__}: {error}\n")
        self._said.add(str(error))

    def warn(self, message):
        """Print one line of warning."""
        vtkOutputWindow.GetInstance().DisplayWarningText(f"{type(self).__name__}: {message}\n")

    def _empty_outputs(self, out_info):
        for port in range(self.GetNumberOfOutputPorts()):
            output = vtkDataObject.GetData(out_info, port)
            if output is not None:
                output.Initialize()

    def run(self):
        """Update the pipeline up to here and return the first output; raise what went wrong, here or upstream.

        Raises
        ------
        TetraskelError
            With the sentence that says what was expected, what came and what to do.
        """
        chain = list(_upstream(self))
        for one in chain:
            if one.last_error is not None:
                one._last_error = None
                one.Modified()  # VTK takes a failed filter for up to date
        self.Update()
        for one in chain:
            if one.last_error is not None:
                raise one.last_error
        return self.GetOutputDataObject(0)

    def tick(self, stage, start=0.0, stop=1.0):
        """A callback for the kernels: tells VTK the share of this stage done; raises `Aborted` when asked to stop.

        `stage` is the text for it, or a function that gives the text for a share. A new text is told at once.
        """

        def told(share):
            text, now = stage(share) if callable(stage) else stage, time.monotonic()
            if now - self._shown < PROGRESS_SECONDS and text == self.GetProgressText():
                return
            self._shown = now
            self.SetProgressText(text)
            self.UpdateProgress(start + (stop - start) * min(share, 1.0))
            if self._stop_asked():
                raise Aborted("stopped on request.")

        return told

    def _stop_asked(self):
        check = getattr(self, "CheckAbort", None)  # VTK 9.3 and later
        return bool(check() if check else self.GetAbortExecute())


def _heard(speaker, event):
    """Observer of a filter and of its executive; a bound method would keep the filter alive for ever."""
    owner = speaker if isinstance(speaker, SkeletonFilter) else speaker.GetAlgorithm()
    if isinstance(owner, SkeletonFilter):
        owner._vtk_complained()


def _upstream(algorithm):
    """This package's filters from the first one to `algorithm`."""
    for port in range(algorithm.GetNumberOfInputPorts()):
        for connection in range(algorithm.GetNumberOfInputConnections(port)):
            yield from _upstream(algorithm.GetInputAlgorithm(port, connection))
    if isinstance(algorithm, SkeletonFilter):
        yield algorithm


def _signature(options):
    """The constructor's keywords, as `help()` shows them."""
    keyword = inspect.Parameter.KEYWORD_ONLY
    taken = [inspect.Parameter(one.name, keyword, default=one.default) for one in fields(options)]
    return inspect.Signature(taken)


def _declare(cls, declared):
    """Give a filter class the setter, getter and property of one option."""
    name = declared.name

    def set_value(self, *given):
        value = _converted(given[0] if len(given) == 1 else given, declared)  # ParaView sends a vector's numbers
        if value is None and isinstance(declared.default, str):
            value = ""  # and None for an empty word
        if self._values[name] != value:
            self._values[name] = value
            self.Modified()

    def set_checked(self, value):
        check_value(name, _converted(value, declared), declared.metadata, declared.default)
        set_value(self, value)

    def get_value(self):
        return self._values[name]

    set_value.__doc__ = get_value.__doc__ = declared.metadata["doc"]
    setattr(cls, f"Set{camel_case(name)}", set_value)
    setattr(cls, f"Get{camel_case(name)}", get_value)
    setattr(cls, name, property(get_value, set_checked, doc=declared.metadata["doc"]))


def _declare_fact(cls, fact):
    """Give a filter class the getter of one fact."""

    def get_fact(self):
        return self.found(fact)

    get_fact.__doc__ = cls.tells[fact]
    setattr(cls, f"GetFound{fact}", get_fact)


def _converted(value, declared):
    """Words of a choice may also come as their number, switches and numbers in any numeric type."""
    choices, default = declared.metadata["choices"], declared.default
    if choices and isinstance(value, Integral) and not isinstance(value, bool) and 0 <= value < len(choices):
        return choices[value]
    if isinstance(default, bool) and value in (0, 1):
        return bool(value)
    if isinstance(default, float) and isinstance(value, Real):
        return float(value)
    if isinstance(default, tuple) and not isinstance(value, (str, Real)):
        return tuple(value)
    return value
