#!/usr/bin/env bash
# Makes a USB gadget that looks like a candleLight adapter, for a program that
# plays its interface through FunctionFS (tactus-fakeskin --function-fs).
#
#   make-gadget.sh GADGET DIRECTORY
#
# GADGET is a directory to be made in configfs, such as
# /sys/kernel/config/usb_gadget/skin; FunctionFS is mounted at DIRECTORY. Needs
# the modules libcomposite and usb_f_fs, and a USB device controller: that of a
# board with a device port, or dummy_hcd.
set -euo pipefail
gadget=$1
directory=$2

mkdir "$gadget"
echo 0x1d50 >"$gadget/idVendor"
echo 0x606f >"$gadget/idProduct"
# The adapter has full speed, whatever the controller can do.
echo full-speed >"$gadget/max_speed"
mkdir "$gadget/strings/0x409"
echo tactus >"$gadget/strings/0x409/manufacturer"
echo "simulated skin" >"$gadget/strings/0x409/product"
echo 0042 >"$gadget/strings/0x409/serialnumber"
mkdir "$gadget/configs/c.1" "$gadget/functions/ffs.skin"
ln -s "$gadget/functions/ffs.skin" "$gadget/configs/c.1/"
mkdir -p "$directory"
mount -t functionfs skin "$directory"
