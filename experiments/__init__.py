"""The paper's tables and figures from our own results, and studies of what is true.

    python -m experiments                      what there is, where it stands in the paper, time
    python -m experiments make [NAME …]        run what needs runs, and keep its small data
    python -m experiments draw [NAME …]        tables, figures and pages from the data that is kept

Every page is one module of `published` or `studies`, see `contents.Module`.
"""
