"""The grammar for programs that hold language models to it: plain rules, made from hymeko.lark. docs/llms.md tells what they leave out."""
