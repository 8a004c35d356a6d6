"""The signals that end a script."""
import signal

STOP_SIGNALS = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)


def on_stop(handler):
    """Call the handler, as of signal.signal(), at each signal that ends a script. Returns the former ones, by signal.

    SIGHUP stays ignored if it is, as nohup(1) wants it. SIGINT does not: shells ignore it for background jobs.
    """
    heeded = [number for number in STOP_SIGNALS
              if number != signal.SIGHUP or signal.getsignal(number) != signal.SIG_IGN]
    return {number: signal.signal(number, handler) for number in heeded}
