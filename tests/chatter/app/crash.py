"""A computation that ends its process, as a fault in compiled code does."""

import os


def ends_at_once(report):
    os._exit(3)
