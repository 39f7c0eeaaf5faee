"""The child process in which xacro files are expanded; the parent starts it and answers its questions.

It opens no file and sees no environment: it asks its parent for every file. Only the standard library,
xacro and yaml are imported here: the start of the child is what an expansion costs.
"""
