"""Errors for people."""


def reason(error):
    """One line: for a file its name and what is wrong with it, without the number of the error."""
    if isinstance(error, OSError) and error.strerror:
        return f"{error.filename}: {error.strerror}" if error.filename else error.strerror
    return " ".join(str(error).split())
