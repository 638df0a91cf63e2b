# SPDX-License-Identifier: MIT
"""Reads a series of frames with ParaView; prints the number of frames, and for the first and the last
one its number of particles and its arrays.

    read_with_paraview.py FILE.pvd
"""

import sys

from paraview.simple import PVDReader

reader = PVDReader(FileName=sys.argv[1])
reader.UpdatePipelineInformation()
times = list(reader.TimestepValues)
print(len(times), "frames")
for time in (times[0], times[-1]):
    reader.UpdatePipeline(time)
    found = reader.GetDataInformation()
    arrays = reader.PointData
    print(found.GetNumberOfPoints(), *sorted(arrays[k].Name for k in range(len(arrays))))
