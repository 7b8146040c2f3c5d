"""dyncal in Python: the mathematics of dyncal on numpy arrays, with the same bits as its programs.

Sines (`fit_sine`, `fit_record`), the paper's methods (`evaluate_sample_stamping`, ...), uncertainty
(`combine`, `propagate_uncertainty`), group delay, sample clocks and interferometers; result files
(`read_result`) and recordings (`read_recording`). Further modules, imported by name: `dyncal.acs`
(a stream that dyncal-acs reads) and `dyncal.dds` (the messages of the network, on the `cyclonedds`
package).

Phase is lead, in rad: a delay is negative. `u` is a standard uncertainty. Units stand in names.
Arrays are taken as they are: int64 stamps in ns, float64 values, contiguous; others are refused.
Everything that fails raises `Error`, with a code and a sentence.
"""

from ._dyncal import *
from .errors import Code as Code
from .errors import Error as Error
from .recording import Recording as Recording
from .recording import Source as Source
from .recording import read_recording as read_recording
from .result import Result as Result
from .result import read_result as read_result
