"""The child process in which xacro files are expanded; `frontends/xacro` starts it and answers its questions.

It opens no file and sees no environment: whatever it wants to read it asks its parent for. Only the standard library,
xacro and yaml are imported here: the start of the child is what an expansion costs.
"""
