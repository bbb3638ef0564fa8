# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""The head command of a public driver, and the sizes of all packets but beams."""

from msss_graphslam.micron.frame import MessageType
from msss_graphslam.micron.packets import Gains, HeadCommand, HeadControl

EXAMPLE_GAINS = Gains(
    ad_span_1=0x50, ad_span_2=0x51, ad_low_1=9, ad_low_2=8, gain_1=0x54, gain_2=0x54
)
EXAMPLE_COMMAND = HeadCommand(
    control=HeadControl.EIGHT_BIT
    | HeadControl.RAW
    | HeadControl.HAS_MOTOR
    | HeadControl.REPLY_ASL,
    head_type=2,
    range_scale=60,
    left_limit=1,
    right_limit=6399,
    ad_span=0x51,
    ad_low=8,
    gain_1=0x54,
    gain_2=0x54,
    step=16,
    ad_interval=141,
    bins=90,
    lockout=919,
    gains=EXAMPLE_GAINS,
)
SIZES = {
    MessageType.VERSION_DATA: {25},
    MessageType.ALIVE: {22},
    MessageType.USER_DATA: {175, 264},
    MessageType.REBOOT: {14},
    MessageType.HEAD_COMMAND: {15, 31, 66, 82},
    MessageType.SEND_VERSION: {14},
    MessageType.SEND_USER_DATA: {14},
    MessageType.SEND_DATA: {18},
    MessageType.FPGA_VERSION_DATA: {28},
    MessageType.CALIBRATION_DATA: {80},
    MessageType.STOP_ALIVES: {14},
}
