"""What is sent on the LCM network before a run begins there."""
import time

import runs
import wire

LISTEN_S = 0.25  # a controller sends its status every cycle, a sender of the scripts every 20 ms
KINDS = ("CONTROLLER_STATUS", "TARGET", "OBSTACLES")
FINGERPRINTS = {kind: wire.TYPES[kind]._get_packed_fingerprint() for kind in KINDS}


def heard(lcm_url="", duration_s=LISTEN_S):
    """{kind: channel} of what others send: statuses of controllers, targets and obstacles, on any channel."""
    found = {}

    def note(channel, data):
        found.update({kind: channel for kind, fingerprint in FINGERPRINTS.items() if data[:8] == fingerprint})
    network = wire.connect(lcm_url)
    network.subscribe(".*", note)
    end = time.monotonic() + duration_s
    while (left_s := end - time.monotonic()) > 0:
        wire.handle_messages(network, left_s)
    return found


def check_free():
    """RunFailed if another controller runs on the default network: two command the same arm. Says who else sends."""
    found = heard()
    if channel := found.pop("CONTROLLER_STATUS", None):
        raise runs.RunFailed(f"another controller runs on this LCM network (it sends on {channel}): end it, or set "
                             "LCM_DEFAULT_URL to another network, such as udpm://239.255.76.67:7668?ttl=0")
    for channel in found.values():
        print(f"note: another program sends on {channel}; the controller follows it as well", flush=True)
