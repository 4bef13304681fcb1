#!/bin/sh
# Prints a unit of deploy/ as its package has it.
#
#   make-unit.sh UNIT
#
# The programs lie in /usr/bin, tactusd is the user tactus, and the comments at
# the head, which install by hand, are left out.
set -eu
if [ "$(basename "$1")" = tactusd.service ]; then
  # The user keeps its data. What DynamicUser= implies beyond what the unit says
  # is said here. The socket and the data are for this user and root.
  user='User=tactus\nGroup=tactus\nStateDirectoryMode=0700\n'
  user="${user}RuntimeDirectoryMode=0700\nRemoveIPC=yes\nRestrictSUIDSGID=yes"
else
  user=DynamicUser=yes
fi
sed -e '1,/^$/d' -e 's|/usr/local/bin/|/usr/bin/|g' \
  -e "s|^DynamicUser=yes\$|$user|" "$1"
