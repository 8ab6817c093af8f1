"""Reports: pages that hold everything they show.

`tether.report.page` is the page, for whatever stands in it; `tether.report.write.report` makes the page of runs and
studies that `tether report` writes.
"""
