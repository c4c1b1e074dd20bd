"""The sections of a case file, in modules named after what they describe."""
